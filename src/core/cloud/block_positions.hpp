#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/cloud/packed_cloud.hpp"

namespace clearway {

/// Positions of the points of a block, an array for each axis, metres.
struct BlockPositions {
  alignas(64) double at[3][kBlockPoints];

  Vec3 point(std::uint32_t i) const { return {at[0][i], at[1][i], at[2][i]}; }

  /// Decodes points first .. first + count - 1 of a cell, at most kBlockPoints.
  void decode(const std::array<PackedChunk<std::int32_t>, 3>& cell,
              const Quantisation& quantisation, std::uint32_t first, std::uint32_t count) {
    std::int32_t stored[kBlockPoints];
    for (int axis = 0; axis < 3; ++axis) {
      cell[static_cast<std::size_t>(axis)].decode(first, std::span(stored, count));
      for (std::uint32_t i = 0; i < count; ++i) {
        at[axis][i] = coordinate(quantisation, axis, stored[i]);
      }
    }
  }
};

}  // namespace clearway
