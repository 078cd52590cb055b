#pragma once

#include <cstdint>

#include "core/util/macros.hpp"

namespace clearway {

/// Number of points of one block, a leaf of the tree inside a cell.
inline constexpr std::uint32_t kBlockPoints = 64;

CLEARWAY_HD constexpr std::uint64_t divide_up(std::uint64_t n, std::uint64_t unit) {
  return (n + unit - 1) / unit;
}

/// The split rule of the store's k-d order: of n > unit points made of units of `unit` points (the
/// last may be short), the left part has unit * ceil(ceil(n / unit) / 2) points.
CLEARWAY_HD constexpr std::uint64_t left_count(std::uint64_t n, std::uint64_t unit) {
  return unit * divide_up(divide_up(n, unit), 2);
}

}  // namespace clearway
