#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>

#include "io/convert/kd_partition.hpp"

namespace clearway {

/// The box of points, in the form of SIMD vectors: the fourth lane is that of the index and not
/// used.
struct QuantumBounds {
  static constexpr std::size_t kLanes = 4;

  std::int32_t lo[kLanes];
  std::int32_t hi[kLanes];

  /// The box of no points.
  QuantumBounds() {
    std::fill_n(lo, kLanes, std::numeric_limits<std::int32_t>::max());
    std::fill_n(hi, kLanes, std::numeric_limits<std::int32_t>::min());
  }

  void extend(std::span<const BucketPoint> points);
};

}  // namespace clearway
