#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/geometry/quantisation.hpp"
#include "io/formats/point_reader.hpp"

namespace clearway {

inline constexpr double kLeastQuantum = std::numeric_limits<std::int32_t>::min();
inline constexpr double kGreatestQuantum = std::numeric_limits<std::int32_t>::max();

inline bool is_finite(const Vec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

/// The position of point i of a batch from a reader with this info.
inline Vec3 point_of(const PointBatch& batch, const CloudInfo& info, std::size_t i) {
  if (!info.quantisation) return batch.positions[i];
  const auto& q = batch.quanta[i];
  return position(*info.quantisation, q[0], q[1], q[2]);
}

}  // namespace clearway
