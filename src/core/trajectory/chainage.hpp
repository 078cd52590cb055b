#pragma once

#include <span>
#include <vector>

#include "clearway/pose.hpp"

namespace clearway {

/// The chainage of each pose, metres: 0 for the first one, then the sum of the distances between
/// consecutive positions, in double and in this order.
std::vector<double> chainage_of(std::span<const Pose> poses);

/// The chainage of the last pose, metres; 0 where there are no poses.
double path_length(std::span<const Pose> poses);

}  // namespace clearway
