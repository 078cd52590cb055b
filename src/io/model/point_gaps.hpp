#pragma once

#include <cstdint>
#include <span>

#include "clearway/vec3.hpp"

namespace clearway {

/// Distances of points to their nearest neighbours, metres.
struct PointGaps {
  double median = 0, largest = 0;
  std::uint64_t repeated = 0;  ///< number of points at the place of another one, which are left out
};

/// The gaps of points; zeros for fewer than two places.
PointGaps gaps_of(std::span<const Vec3> points);

}  // namespace clearway
