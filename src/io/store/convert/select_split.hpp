#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "io/store/convert/stage_clocks.hpp"

namespace clearway {

/// A point while its bucket is being ordered, 16 bytes. `index` is its position among the loaded
/// points, which are in source order.
struct BucketPoint {
  std::int32_t q[3];
  std::uint32_t index;
};

/// Puts the points of a bucket in the store's k-d order (docs/design/store-format.md, "Order of the
/// points"): cells of `cell_points`, and blocks of 64 within these. points: in source order.
/// scratch: as many points, overwritten. scale: metres per integer step on each axis. Uses the
/// threads of the calling TBB arena.
void order_bucket(std::span<BucketPoint> points, std::span<BucketPoint> scratch,
                  std::uint32_t cell_points, const double (&scale)[3], StageClocks& clocks);

/// Integer coordinates on one axis, both ends included.
struct QuantumRange {
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
                     QuantumRange range, BucketPoint* scratch);

}  // namespace clearway
