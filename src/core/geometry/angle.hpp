#pragma once

#include <numbers>

namespace clearway {

inline constexpr double kDegree = std::numbers::pi / 180;  ///< radians

}  // namespace clearway
