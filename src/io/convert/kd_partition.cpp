#include "io/convert/kd_partition.hpp"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <vector>

#include "core/cloud/kd_order.hpp"
#include "core/util/macros.hpp"
#include "core/util/tsan_annotations.hpp"

namespace clearway {
namespace {

/// Points from which a histogram finds the median's bin.
constexpr std::size_t kHistogramFrom = 1024;
constexpr unsigned kHistogramBits = 10;
constexpr std::size_t kParallelFrom = 1 << 16;

struct Bounds {
  std::int32_t lo[4];  // the fourth lane is the index, unused
  std::int32_t hi[4];
};

CLEARWAY_SIMD_CLONES
Bounds bounds_of(const BucketPoint* points, std::size_t n) {
  static_assert(sizeof(BucketPoint) == 4 * sizeof(std::int32_t));
  Bounds b;
  std::fill_n(b.lo, 4, std::numeric_limits<std::int32_t>::max());
  std::fill_n(b.hi, 4, std::numeric_limits<std::int32_t>::min());
  for (std::size_t i = 0; i < n; ++i) {
    std::int32_t lanes[4];
    std::memcpy(lanes, points + i, sizeof lanes);
    for (int k = 0; k < 4; ++k) {
      b.lo[k] = lanes[k] < b.lo[k] ? lanes[k] : b.lo[k];
      b.hi[k] = lanes[k] > b.hi[k] ? lanes[k] : b.hi[k];
    }
  }
  return b;
}

std::uint32_t extent(const Bounds& b, int axis) {
  return static_cast<std::uint32_t>(b.hi[axis]) - static_cast<std::uint32_t>(b.lo[axis]);
}

int longest_side(const Bounds& b, const double* scale) {
  int longest = 0;
  double length = extent(b, 0) * scale[0];
  for (int axis = 1; axis < 3; ++axis) {
    const double side = extent(b, axis) * scale[axis];
    if (side > length) {
      length = side;
      longest = axis;
    }
  }
  return longest;
}

/// Orders points by coordinate, then by position: points are in source order, so ties go by source
/// index. One 64-bit comparison.
class SplitKey {
 public:
  SplitKey(int axis, std::int32_t lowest) : axis_(axis), lowest_(lowest) {}
  std::uint32_t distance(const BucketPoint& p) const {
    return static_cast<std::uint32_t>(p.q[axis_]) - static_cast<std::uint32_t>(lowest_);
  }
  std::uint64_t operator()(const BucketPoint& p, std::size_t at) const {
    return std::uint64_t{distance(p)} << 32 | at;
  }

 private:
  int axis_;
  std::int32_t lowest_;
};

/// The key of rank `rank` among `n` points.
std::uint64_t select(const BucketPoint* points, std::size_t n, std::size_t rank, SplitKey key,
                     std::uint32_t side) {
  static thread_local std::vector<std::uint64_t> keys;
  keys.clear();
  if (n < kHistogramFrom) {
    for (std::size_t i = 0; i < n; ++i) keys.push_back(key(points[i], i));
  } else {
    const auto bits = static_cast<unsigned>(std::bit_width(side));
    const unsigned shift = bits > kHistogramBits ? bits - kHistogramBits : 0;
    std::array<std::uint32_t, std::size_t{1} << kHistogramBits> histogram{};
    for (std::size_t i = 0; i < n; ++i) ++histogram[key.distance(points[i]) >> shift];
    std::uint32_t bin = 0;
    while (rank >= histogram[bin]) rank -= histogram[bin++];
    for (std::size_t i = 0; i < n; ++i) {
      if (key.distance(points[i]) >> shift == bin) keys.push_back(key(points[i], i));
    }
  }
  std::nth_element(keys.begin(), keys.begin() + static_cast<std::ptrdiff_t>(rank), keys.end());
  return keys[rank];
}

/// Copies the points below `pivot` to the front of `to` and the others behind them, each side in
/// the order they come.
void partition_stably(const BucketPoint* from, BucketPoint* to, std::size_t n, std::size_t left,
                      SplitKey key, std::uint64_t pivot) {
  BucketPoint* out[2] = {to + left, to};
  for (std::size_t i = 0; i < n; ++i) {
    const bool below = key(from[i], i) < pivot;
    *out[below] = from[i];
    ++out[below];
  }
}

class BucketOrder {
 public:
  BucketOrder(std::uint32_t cell_points, const double* scale, StageClocks& clocks)
      : cell_points_(cell_points), scale_(scale), clocks_(clocks) {}

  /// Orders n points of `from`; the outcome goes to `result`, which is `from` or `other`.
  void order(BucketPoint* from, BucketPoint* other, BucketPoint* result, std::size_t n) const {
    if (n < kParallelFrom) {
      const auto running = clocks_.measure(Stage::kOrder);
      order_alone(from, other, result, n);
      return;
    }
    const std::size_t left = split_measured(from, other, n);
    const ParallelScope scope;
    const auto order_left = piece_of(scope, [=, this] { order(other, from, result, left); });
    const auto order_right =
        piece_of(scope, [=, this] { order(other + left, from + left, result + left, n - left); });
    scope.begin();
    tbb::parallel_invoke(order_left, order_right);
  }

 private:
  static_assert(kParallelFrom > kBlockPoints);

  /// On one thread.
  void order_alone(BucketPoint* from, BucketPoint* other, BucketPoint* result,
                   std::size_t n) const {
    if (n <= kBlockPoints) {
      if (result != from) std::copy(from, from + n, result);
      return;
    }
    const std::size_t left = split(from, other, n);
    order_alone(other, from, result, left);
    order_alone(other + left, from + left, result + left, n - left);
  }

  std::size_t split_measured(const BucketPoint* from, BucketPoint* to, std::size_t n) const {
    const auto running = clocks_.measure(Stage::kOrder);
    return split(from, to, n);
  }

  /// Parts n > kBlockPoints points; how many of them are left.
  std::size_t split(const BucketPoint* from, BucketPoint* to, std::size_t n) const {
    const std::size_t left = left_count(n, n > cell_points_ ? cell_points_ : kBlockPoints);
    const Bounds bounds = bounds_of(from, n);
    const int axis = longest_side(bounds, scale_);
    const SplitKey key(axis, bounds.lo[axis]);
    partition_stably(from, to, n, left, key, select(from, n, left, key, extent(bounds, axis)));
    return left;
  }

  std::uint64_t cell_points_;
  const double* scale_;
  StageClocks& clocks_;
};

}  // namespace

void order_bucket(std::span<BucketPoint> points, std::span<BucketPoint> scratch,
                  std::uint32_t cell_points, const double (&scale)[3], StageClocks& clocks) {
  BucketOrder(cell_points, scale, clocks)
      .order(points.data(), scratch.data(), points.data(), points.size());
}

}  // namespace clearway
