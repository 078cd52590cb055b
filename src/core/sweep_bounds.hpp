#pragma once

#include <limits>

namespace clearway {

inline constexpr double kUnitRoundoff = std::numeric_limits<double>::epsilon() / 2;

/// Widens a product or sum of a few roundings.
inline constexpr double kRoundedUp = 1 + 16 * kUnitRoundoff;

/// True only when sigma * sqrt(squared_lower) >= reach, rounding included; false for NaN and where
/// the reach overflows.
inline bool farther(double sigma, double squared_lower, double reach) {
  const double squared_reach = reach * reach * kRoundedUp;
  return squared_reach <= std::numeric_limits<double>::max() &&
         sigma * sigma * squared_lower >= squared_reach;
}

}  // namespace clearway
