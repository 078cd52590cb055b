#pragma once

#include <span>
#include <vector>

#include "clearway/pose.hpp"

namespace clearway {

/// Of each pose the metres along the positions of the path: 0 at the first one, then the sum of the
/// distances of consecutive positions, in double and in this order.
std::vector<double> chainage_of(std::span<const Pose> poses);

}  // namespace clearway
