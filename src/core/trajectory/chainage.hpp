#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "clearway/pose.hpp"
#include "clearway/vec3.hpp"

namespace clearway {

/// The chainage of each pose, metres: 0 for the first one, then the sum of the distances between
/// consecutive positions, in double and in this order.
std::vector<double> chainage_of(std::span<const Pose> poses);

/// The chainage of the last pose, metres; 0 where there are no poses.
double path_length(std::span<const Pose> poses);

/// The value at a place of a path, interpolated linearly along the way between the values of its
/// poses; beyond an end that of the end. Where several poses are at the place, the last of them
/// counts. chainage: ascending, metres; values: one for each pose, at least one.
double value_at(std::span<const double> chainage, std::span<const double> values, double at);

/// The direction in which the path runs at a pose, a unit vector: that of the chord from the last
/// pose before it to the first one after it, or to the pose itself where the path ends or turns
/// back there. Poses within 0.1 m of it are passed over, because a vehicle that stands still
/// jitters in any direction. None where no pose is farther away.
std::optional<Vec3> travel_direction(std::span<const Pose> poses, std::size_t at);

}  // namespace clearway
