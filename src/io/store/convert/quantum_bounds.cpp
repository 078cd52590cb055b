#include "io/store/convert/quantum_bounds.hpp"

#include <cstring>

#include "core/util/macros.hpp"

namespace clearway {
namespace {

constexpr std::size_t kPointsAtOnce = 4;  // as many as fill the widest vectors

CLEARWAY_SIMD_CLONES
void extend_by(QuantumBounds& b, const BucketPoint* points, std::size_t n) {
  constexpr std::size_t kLanes = QuantumBounds::kLanes;
  static_assert(sizeof(BucketPoint) == kLanes * sizeof(std::int32_t));
  std::int32_t lo[kPointsAtOnce * kLanes];
  std::int32_t hi[kPointsAtOnce * kLanes];
  for (std::size_t k = 0; k < kPointsAtOnce * kLanes; ++k) {
    lo[k] = b.lo[k % kLanes];
    hi[k] = b.hi[k % kLanes];
  }
  std::size_t i = 0;
  for (; i + kPointsAtOnce <= n; i += kPointsAtOnce) {
    std::int32_t lanes[kPointsAtOnce * kLanes];
    std::memcpy(lanes, points + i, sizeof lanes);
    for (std::size_t k = 0; k < kPointsAtOnce * kLanes; ++k) {
      lo[k] = lanes[k] < lo[k] ? lanes[k] : lo[k];
      hi[k] = lanes[k] > hi[k] ? lanes[k] : hi[k];
    }
  }
  for (std::size_t k = 0; k < kPointsAtOnce * kLanes; ++k) {
    b.lo[k % kLanes] = std::min(b.lo[k % kLanes], lo[k]);
    b.hi[k % kLanes] = std::max(b.hi[k % kLanes], hi[k]);
  }
  for (; i < n; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      b.lo[k] = std::min(b.lo[k], points[i].q[k]);
      b.hi[k] = std::max(b.hi[k], points[i].q[k]);
    }
  }
}

}  // namespace

void QuantumBounds::extend(std::span<const BucketPoint> points) {
  extend_by(*this, points.data(), points.size());
}

}  // namespace clearway
