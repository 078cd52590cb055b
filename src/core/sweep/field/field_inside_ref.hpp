#pragma once

#include <cstdint>

#include "core/geometry/solid_parts_ref.hpp"

namespace clearway {

/// View of a FieldInside on the host or on a device. Does not own it.
struct FieldInsideRef {
  SolidPartsRef solids;
  const std::uint8_t* cells = nullptr;  ///< 1 for each coarse cell that has no brick and is inside
  /// One bit for each node, 1 if it is inside; brick after brick
  const std::uint32_t* nodes = nullptr;

  /// Number of words that hold one bit for each node of a brick.
  CLEARWAY_HD static constexpr std::uint32_t words_for(std::uint32_t brick_nodes) {
    return (brick_nodes + 31) / 32;
  }

  CLEARWAY_HD bool node(std::size_t first_word, std::uint32_t node) const {
    return (nodes[first_word + node / 32] >> (node % 32) & 1) != 0;
  }
};

}  // namespace clearway
