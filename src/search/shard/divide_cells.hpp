#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace clearway {

/// Which of `shards` parts, from 0, each cell is in: the cells with work in the order of falling
/// work, each to the part that has the least so far, so that no part has more than the mean and the
/// largest cell. Cells without work are spread by their number. Of equals the first.
/// Source: Graham 1969, "longest processing time".
std::vector<std::uint32_t> divide_cells(std::span<const std::uint64_t> work, std::uint32_t shards);

}  // namespace clearway
