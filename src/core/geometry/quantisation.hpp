#pragma once

#include <cstdint>

#include "clearway/vec3.hpp"
#include "core/geometry/box.hpp"
#include "core/geometry/predicate.hpp"

namespace clearway {

/// Scale and offset for each axis, metres. The position of a stored point is by definition q *
/// scale + offset in double, with each operation rounded; it is monotone in q for a scale > 0.
struct Quantisation {
  double scale[3];
  double offset[3];
  friend bool operator==(const Quantisation&, const Quantisation&) = default;
};

CLEARWAY_HD inline double coordinate(const Quantisation& quantisation, int axis, std::int32_t q) {
  return rounded_sum(rounded_product(static_cast<double>(q), quantisation.scale[axis]),
                     quantisation.offset[axis]);
}

CLEARWAY_HD inline Vec3 position(const Quantisation& quantisation, std::int32_t qx, std::int32_t qy,
                                 std::int32_t qz) {
  return {coordinate(quantisation, 0, qx), coordinate(quantisation, 1, qy),
          coordinate(quantisation, 2, qz)};
}

/// Axis-aligned box of stored integers, closed on both sides.
struct QuantumBox {
  std::int32_t lo[3];
  std::int32_t hi[3];
  friend bool operator==(const QuantumBox&, const QuantumBox&) = default;

  /// Grows the box until it holds q.
  CLEARWAY_HD void extend(const std::int32_t* q) {
    for (int k = 0; k < 3; ++k) {
      if (q[k] < lo[k]) lo[k] = q[k];
      if (q[k] > hi[k]) hi[k] = q[k];
    }
  }

  /// The smallest box that holds both boxes.
  CLEARWAY_HD QuantumBox united(const QuantumBox& other) const {
    QuantumBox out = *this;
    out.extend(other.lo);
    out.extend(other.hi);
    return out;
  }
};

/// The box of the positions of a box of integers. It is exact, because a position is monotone in
/// its integers.
CLEARWAY_HD inline Box position_box(const Quantisation& quantisation, const QuantumBox& box) {
  return {position(quantisation, box.lo[0], box.lo[1], box.lo[2]),
          position(quantisation, box.hi[0], box.hi[1], box.hi[2])};
}

/// A block's box inside its cell's box, in steps of the cell's extent / 65535 on each axis, rounded
/// outwards. Takes 12 bytes.
struct BlockBox {
  std::uint16_t lo[3];
  std::uint16_t hi[3];
  friend bool operator==(const BlockBox&, const BlockBox&) = default;

  /// The smallest box that holds both boxes, which are in steps of the same cell.
  CLEARWAY_HD BlockBox united(const BlockBox& other) const {
    BlockBox out = *this;
    for (int k = 0; k < 3; ++k) {
      if (other.lo[k] < out.lo[k]) out.lo[k] = other.lo[k];
      if (other.hi[k] > out.hi[k]) out.hi[k] = other.hi[k];
    }
    return out;
  }
};

inline constexpr std::uint64_t kBlockBoxSteps = 65535;

/// Encodes the box of a block that lies in `cell`. The decoded box holds `block` and exceeds it by
/// at most a step (and a quantum) on any side.
CLEARWAY_HD inline BlockBox encode_block_box(const QuantumBox& cell, const QuantumBox& block) {
  BlockBox out;
  for (int k = 0; k < 3; ++k) {
    const auto extent = static_cast<std::uint64_t>(std::int64_t{cell.hi[k]} - cell.lo[k]);
    const auto lo = static_cast<std::uint64_t>(std::int64_t{block.lo[k]} - cell.lo[k]);
    const auto hi = static_cast<std::uint64_t>(std::int64_t{cell.hi[k]} - block.hi[k]);
    out.lo[k] = static_cast<std::uint16_t>(extent == 0 ? 0 : lo * kBlockBoxSteps / extent);
    out.hi[k] = static_cast<std::uint16_t>(
        extent == 0 ? kBlockBoxSteps : kBlockBoxSteps - hi * kBlockBoxSteps / extent);
  }
  return out;
}

/// Decodes the box of a block to integers, rounded outwards, so that it holds every point of the
/// block.
CLEARWAY_HD inline QuantumBox decode_block_box(const QuantumBox& cell, const BlockBox& block) {
  QuantumBox out;
  for (int k = 0; k < 3; ++k) {
    const auto extent = static_cast<std::uint64_t>(std::int64_t{cell.hi[k]} - cell.lo[k]);
    const std::uint64_t lo = block.lo[k] * extent / kBlockBoxSteps;
    const std::uint64_t hi = (kBlockBoxSteps - block.hi[k]) * extent / kBlockBoxSteps;
    out.lo[k] = static_cast<std::int32_t>(cell.lo[k] + static_cast<std::int64_t>(lo));
    out.hi[k] = static_cast<std::int32_t>(cell.hi[k] - static_cast<std::int64_t>(hi));
  }
  return out;
}

}  // namespace clearway
