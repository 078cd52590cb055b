#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace clearway {

/// The part of each cell, from 0 to shards - 1. Cells are taken in the order of decreasing work,
/// and each goes to the part that has the least work so far, so that no part has more than the mean
/// and the work of the largest cell. Cells without work are spread by their index. Among equal
/// cells or parts the first is taken.
/// Source: Graham 1969, "longest processing time".
std::vector<std::uint32_t> divide_cells(std::span<const std::uint64_t> work, std::uint32_t shards);

}  // namespace clearway
