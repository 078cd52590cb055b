#include "io/store/convert/select_split.hpp"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/cloud/packed_cloud.hpp"
#include "core/util/macros.hpp"
#include "core/util/tsan_annotations.hpp"
#include "io/store/convert/quantum_bounds.hpp"

namespace clearway {
namespace {

/// Up to this many points, all coordinates are bisected; for more points, only those near the value
/// that a sample suggests.
constexpr std::size_t kBisectAll = 4096;

std::int32_t ahead(std::int32_t lo, std::uint32_t steps) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(lo) + steps);
}

std::uint32_t extent(QuantumRange range) {
  return static_cast<std::uint32_t>(range.hi) - static_cast<std::uint32_t>(range.lo);
}

/// The split of n coordinates within `range`. It counts the coordinates below a value repeatedly,
/// which needs no branch that depends on a point and uses full vectors.
CLEARWAY_SIMD_CLONES
KdSplit bisect(const std::int32_t* q, std::size_t n, std::size_t left, QuantumRange range) {
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
Collected collect(std::span<const BucketPoint> points, int axis, QuantumRange range,
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
QuantumRange probable_range(std::span<const BucketPoint> points, std::size_t left, int axis,
                            QuantumRange range, std::int32_t* q) {
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
                     QuantumRange range, BucketPoint* scratch) {
  auto* const q = reinterpret_cast<std::int32_t*>(scratch);
  if (points.size() <= kBisectAll) {
    coordinates(points.data(), points.size(), 1, axis, q);
    return bisect(q, points.size(), left, range);
  }
  QuantumRange near = probable_range(points, left, axis, range, q);
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

namespace {

constexpr std::size_t kParallelFrom = 1 << 16;
/// Number of points that are divided before the boxes of the two sides are updated, while they are
/// still in cache.
constexpr std::size_t kPartedAtOnce = 1024;

int longest_side(const QuantumBounds& b, const double* scale) {
  const auto side = [&](int k) {
    return (static_cast<std::uint32_t>(b.hi[k]) - static_cast<std::uint32_t>(b.lo[k])) * scale[k];
  };
  int longest = 0;
  for (int axis = 1; axis < 3; ++axis) {
    if (side(axis) > side(longest)) longest = axis;
  }
  return longest;
}

/// Copies the points left of a split to the front of `to` and the others after them. Each side
/// keeps the order of the points, which come in source order, so that ties are broken by source
/// index.
class Parting {
 public:
  Parting(BucketPoint* to, std::size_t left, int axis, KdSplit split)
      : to_(to), right_(left), axis_(axis), split_(split) {}

  void add(const BucketPoint* points, std::size_t n) {
    const std::size_t left = left_;
    const std::size_t right = right_;
    if (split_.equal == 0) {
      add<false>(points, n);
    } else {
      add<true>(points, n);
    }
    bounds_[0].extend({to_ + left, left_ - left});
    bounds_[1].extend({to_ + right, right_ - right});
  }

  const QuantumBounds& left_bounds() const { return bounds_[0]; }
  const QuantumBounds& right_bounds() const { return bounds_[1]; }

 private:
  /// Adds points without a branch that depends on a point. Each point is stored once, because
  /// storing it to both sides would write beyond a side that is full.
  template <bool kTies>
  void add(const BucketPoint* points, std::size_t n) {
    std::size_t left = left_;
    std::size_t right = right_;
    std::size_t equal = split_.equal;
    for (std::size_t i = 0; i < n; ++i) {
      const std::int32_t q = points[i].q[axis_];
      std::size_t is_left = q < split_.value ? 1 : 0;
      if constexpr (kTies) {
        const std::size_t tie = (q == split_.value ? 1u : 0u) & (equal != 0 ? 1u : 0u);
        is_left += tie;
        equal -= tie;
      }
      to_[is_left != 0 ? left : right] = points[i];
      left += is_left;
      right += 1 - is_left;
    }
    left_ = left;
    right_ = right;
    split_.equal = equal;
  }

  BucketPoint* to_;
  std::size_t left_ = 0;
  std::size_t right_;
  int axis_;
  KdSplit split_;
  QuantumBounds bounds_[2];
};

class BucketOrder {
 public:
  BucketOrder(std::uint32_t cell_points, const double* scale, StageClocks& clocks)
      : cell_points_(cell_points), scale_(scale), clocks_(clocks) {}

  /// Orders n points of `from` within `bounds`. The outcome goes to `result`, which is `from` or
  /// `other`.
  void order(BucketPoint* from, BucketPoint* other, BucketPoint* result, std::size_t n,
             const QuantumBounds& bounds) const {
    if (n < kParallelFrom) {
      const auto running = clocks_.measure(Stage::kOrder);
      order_alone(from, other, result, n, bounds);
      return;
    }
    const Parts parts = split_measured(from, other, n, bounds);
    const std::size_t left = parts.left;
    const ParallelScope scope;
    const auto order_left =
        piece_of(scope, [&, this] { order(other, from, result, left, parts.bounds[0]); });
    const auto order_right = piece_of(scope, [&, this] {
      order(other + left, from + left, result + left, n - left, parts.bounds[1]);
    });
    scope.begin();
    tbb::parallel_invoke(order_left, order_right);
  }

 private:
  static_assert(kParallelFrom > kBlockPoints);

  struct Parts {
    std::size_t left;
    QuantumBounds bounds[2];
  };

  /// Orders n points of `from` within `bounds` on one thread. The outcome goes to `result`.
  void order_alone(BucketPoint* from, BucketPoint* other, BucketPoint* result, std::size_t n,
                   const QuantumBounds& bounds) const {
    if (n <= kBlockPoints) {
      if (result != from) std::copy(from, from + n, result);
      return;
    }
    const auto [left, halves] = split(from, other, n, bounds);
    order_alone(other, from, result, left, halves[0]);
    order_alone(other + left, from + left, result + left, n - left, halves[1]);
  }

  Parts split_measured(const BucketPoint* from, BucketPoint* to, std::size_t n,
                       const QuantumBounds& bounds) const {
    const auto running = clocks_.measure(Stage::kOrder);
    return split(from, to, n, bounds);
  }

  /// Divides n > kBlockPoints points of `from` at the median split into the two sides of `to`.
  Parts split(const BucketPoint* from, BucketPoint* to, std::size_t n,
              const QuantumBounds& bounds) const {
    const std::size_t left = left_count(n, n > cell_points_ ? cell_points_ : kBlockPoints);
    const int axis = longest_side(bounds, scale_);
    const QuantumRange range{bounds.lo[axis], bounds.hi[axis]};
    Parting parting(to, left, axis, select_split({from, n}, left, axis, range, to));
    for (std::size_t at = 0; at < n; at += kPartedAtOnce) {
      parting.add(from + at, std::min(kPartedAtOnce, n - at));
    }
    return {left, {parting.left_bounds(), parting.right_bounds()}};
  }

  std::uint64_t cell_points_;
  const double* scale_;
  StageClocks& clocks_;
};

}  // namespace

void order_bucket(std::span<BucketPoint> points, std::span<BucketPoint> scratch,
                  std::uint32_t cell_points, const double (&scale)[3], StageClocks& clocks) {
  QuantumBounds bounds;
  {
    const auto running = clocks.measure(Stage::kOrder);
    bounds.extend(points);
  }
  BucketOrder(cell_points, scale, clocks)
      .order(points.data(), scratch.data(), points.data(), points.size(), bounds);
}

}  // namespace clearway
