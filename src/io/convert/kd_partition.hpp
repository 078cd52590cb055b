#pragma once

#include <cstdint>
#include <span>

#include "io/convert/stage_clocks.hpp"

namespace clearway {

/// A point while its bucket is being ordered, 16 bytes. `index` is its position among the loaded
/// points, which are in source order.
struct BucketPoint {
  std::int32_t q[3];
  std::uint32_t index;
};

/// Puts the points of a bucket in the store's k-d order (docs/design/store-format.md, "Order"):
/// cells of `cell_points`, and blocks of 64 within these. points: in source order. scratch: as many
/// points, overwritten. scale: metres per integer step on each axis. Uses the threads of the
/// calling TBB arena.
void order_bucket(std::span<BucketPoint> points, std::span<BucketPoint> scratch,
                  std::uint32_t cell_points, const double (&scale)[3], StageClocks& clocks);

}  // namespace clearway
