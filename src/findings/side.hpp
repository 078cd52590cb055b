#pragma once

#include "clearway/box.hpp"
#include "clearway/conflicts.hpp"
#include "clearway/pose.hpp"
#include "clearway/vec3.hpp"

namespace clearway {

/// Whether two axes lie along one line.
bool along_one_line(Axis a, Axis b);

/// The unit vector to the left in the model's frame.
Vec3 direction_to_left(Axis forward, Axis up);

/// The vector from the position of a pose to a place, along the model's axes: ahead, to the left,
/// up.
Vec3 ahead_left_up(const Vec3& place, const Pose& pose, Axis forward, Axis up);

/// On which side of the model's box another box lies. seen: the other box, along the axes of
/// ahead_left_up(). The side is left, right, above or below where the whole box lies beyond that
/// side, namely the side that it is farthest beyond. Otherwise the box is in the way: in front or
/// behind where all of it lies ahead or behind. For a box that reaches into the model's, it is the
/// side on which it would be outside soonest. Among equal sides, the first of left, right, above,
/// below, front, behind.
Side side_of(const Box& seen, const Box& model, Axis forward, Axis up);

/// A box of the model's frame, along the axes of ahead_left_up().
Box turned(const Box& box, Axis forward, Axis up);

}  // namespace clearway
