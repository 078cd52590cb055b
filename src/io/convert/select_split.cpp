#include "io/convert/select_split.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/util/macros.hpp"

namespace clearway {
namespace {

/// Up to this many points, all coordinates are bisected; for more points, only those near the value
/// that a sample suggests.
constexpr std::size_t kBisectAll = 4096;

std::int32_t ahead(std::int32_t lo, std::uint32_t steps) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(lo) + steps);
}

std::uint32_t extent(CoordinateRange range) {
  return static_cast<std::uint32_t>(range.hi) - static_cast<std::uint32_t>(range.lo);
}

/// The split of n coordinates within `range`. It counts the coordinates below a value repeatedly,
/// which needs no branch that depends on a point and uses full vectors.
CLEARWAY_SIMD_CLONES
KdSplit bisect(const std::int32_t* q, std::size_t n, std::size_t left, CoordinateRange range) {
  std::size_t below_lo = 0;
  while (range.lo < range.hi) {
    const std::int32_t middle = ahead(range.lo, extent(range) / 2 + 1);
    std::uint32_t below = 0;
    for (std::size_t i = 0; i < n; ++i) below += q[i] < middle ? 1 : 0;
    if (below == left) return {middle, 0};
    if (below < left) {
      range.lo = middle;
      below_lo = below;
    } else {
      range.hi = middle - 1;
    }
  }
  return {range.lo, left - below_lo};
}

CLEARWAY_SIMD_CLONES
void coordinates(const BucketPoint* points, std::size_t n, std::size_t step, int axis,
                 std::int32_t* q) {
  for (std::size_t i = 0; i < n; ++i) q[i] = points[i * step].q[axis];
}

struct Collected {
  std::size_t below, within;
};

/// Copies the coordinates within `range` to `q`. Returns how many are below it, and how many
/// within.
Collected collect(std::span<const BucketPoint> points, int axis, CoordinateRange range,
                  std::int32_t* q) {
  const std::uint32_t length = extent(range);
  Collected found{0, 0};
  for (const BucketPoint& p : points) {
    const std::int32_t at = p.q[axis];
    q[found.within] = at;
    found.within +=
        static_cast<std::uint32_t>(at) - static_cast<std::uint32_t>(range.lo) <= length ? 1 : 0;
    found.below += at < range.lo ? 1 : 0;
  }
  return found;
}

/// The range in which the value of rank `left` probably lies: three standard deviations of the rank
/// in a sample.
CoordinateRange probable_range(std::span<const BucketPoint> points, std::size_t left, int axis,
                               CoordinateRange range, std::int32_t* q) {
  const std::size_t sample = std::size_t{128} << (std::bit_width(points.size()) / 2 - 5);
  coordinates(points.data(), sample, points.size() / sample, axis, q);
  const std::size_t rank = left * sample / points.size();
  const auto margin = static_cast<std::size_t>(1.5 * std::sqrt(static_cast<double>(sample)));
  const std::size_t lower = rank < margin ? 0 : rank - margin;
  const std::size_t upper = std::min(rank + margin, sample - 1);
  return {bisect(q, sample, lower, range).value, bisect(q, sample, upper, range).value};
}

}  // namespace

KdSplit select_split(std::span<const BucketPoint> points, std::size_t left, int axis,
                     CoordinateRange range, BucketPoint* scratch) {
  auto* const q = reinterpret_cast<std::int32_t*>(scratch);
  if (points.size() <= kBisectAll) {
    coordinates(points.data(), points.size(), 1, axis, q);
    return bisect(q, points.size(), left, range);
  }
  CoordinateRange near = probable_range(points, left, axis, range, q);
  Collected found = collect(points, axis, near, q);
  if (left < found.below) {
    near = {range.lo, near.lo - 1};
    found = collect(points, axis, near, q);
  } else if (left >= found.below + found.within) {
    near = {near.hi + 1, range.hi};
    found = collect(points, axis, near, q);
  }
  return bisect(q, found.within, left - found.below, near);
}

}  // namespace clearway
