#pragma once

#include "clearway/box.hpp"
#include "clearway/conflicts.hpp"
#include "clearway/pose.hpp"
#include "clearway/vec3.hpp"

namespace clearway {

/// Whether two axes lie along one line.
bool along_one_line(Axis a, Axis b);

/// The direction to the left in the model's frame, of length 1.
Vec3 direction_to_left(Axis forward, Axis up);

/// From the position of a pose to a place along the model's axes: ahead, to the left, up.
Vec3 ahead_left_up(const Vec3& place, const Pose& pose, Axis forward, Axis up);

/// Where a box lies that is known along these axes (ahead_left_up), seen from the model's box:
/// left, right, above or below where all of it lies beyond that side, the side that it is farthest
/// beyond; otherwise, it is in the way: front or behind where all of it lies ahead or behind; and
/// of a box that reaches into the model's the side on which it would be outside soonest. Of equal
/// ones the first of left, right, above, below, front, behind.
Side side_of(const Box& seen, const Box& model, Axis forward, Axis up);

/// A box of the model's frame along the axes of ahead_left_up.
Box turned(const Box& box, Axis forward, Axis up);

}  // namespace clearway
