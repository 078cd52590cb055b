#pragma once

#include <numbers>

namespace clearway {

inline constexpr double kDegree = std::numbers::pi / 180;  ///< one degree in radians

}  // namespace clearway
