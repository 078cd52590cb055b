#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "io/convert/kd_partition.hpp"

namespace clearway {

/// Integer coordinates on one axis, both ends included.
struct CoordinateRange {
  std::int32_t lo, hi;
};

/// A plane that divides points: on its left are those below `value`, and the first `equal` of those
/// at it.
struct KdSplit {
  std::int32_t value;
  std::size_t equal;
};

/// The plane that has `left` of the points, fewer than all, on its left. range: of their
/// coordinates on `axis`. scratch: as many points as `points`, overwritten.
KdSplit select_split(std::span<const BucketPoint> points, std::size_t left, int axis,
                     CoordinateRange range, BucketPoint* scratch);

}  // namespace clearway
