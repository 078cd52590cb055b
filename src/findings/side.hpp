#pragma once

#include "clearway/box.hpp"
#include "clearway/conflicts.hpp"
#include "clearway/pose.hpp"
#include "clearway/vec3.hpp"

namespace clearway {

/// Whether two axes lie along one line.
bool along_one_line(Axis a, Axis b);

/// From the position of a pose to a place along the model's axes: ahead, to the left, up.
Vec3 ahead_left_up(const Vec3& place, const Pose& pose, Axis forward, Axis up);

/// Where a place lies, seen from the box of the model at a pose: the side of the box beyond which
/// it is farthest; of a place inside the box the nearest side. Of equal ones the first of left,
/// right, above, below, front, behind.
Side side_of(const Vec3& place, const Pose& pose, const Box& model, Axis forward, Axis up);

}  // namespace clearway
