#pragma once

#include <cmath>
#include <limits>

#include "core/geometry/box.hpp"
#include "core/geometry/predicate.hpp"

/// Constants and bounds that the filters of the sweep share.
namespace clearway {

inline constexpr double kUnitRoundoff = 0x1p-53;

/// Factor that widens a product or sum of a few roundings to an upper bound.
inline constexpr double kRoundedUp = 1 + 16 * kUnitRoundoff;

/// Factor that lowers the product or quotient of a few roundings to a lower bound.
inline constexpr double kRoundedDown = 1 - 16 * kUnitRoundoff;

inline constexpr double kLargestDouble = std::numeric_limits<double>::max();
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

CLEARWAY_HD inline double greater_of(double a, double b) { return a < b ? b : a; }

/// Upper bound on half the diagonal of a box.
CLEARWAY_HD inline double half_diagonal(const Box& box) {
  const double x = box.hi.x - box.lo.x, y = box.hi.y - box.lo.y, z = box.hi.z - box.lo.z;
  return 0.5 * std::sqrt(squared_length(x, y, z)) * kRoundedUp;
}

/// True only if sigma * sqrt(squared_lower) >= reach, rounding included; false for NaN and if the
/// reach overflows.
CLEARWAY_HD inline bool farther(double sigma, double squared_lower, double reach) {
  const double squared_reach = reach * reach * kRoundedUp;
  return squared_reach <= kLargestDouble && sigma * sigma * squared_lower >= squared_reach;
}

}  // namespace clearway
