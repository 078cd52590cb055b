#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/util/progress.hpp"
#include "findings/group/cell_grid.hpp"
#include "findings/group/union_find.hpp"

namespace clearway {

/// The groups of a grid's points: each is a set of cells.
struct PointGroups {
  /// A small group has a number of its own, from 0, with this bit.
  static constexpr std::uint32_t kSmall = std::uint32_t{1} << 31;
  static bool is_small(std::uint32_t group) { return (group & kSmall) != 0; }

  std::vector<std::uint32_t> of_cell;  ///< a number of those below, or of a small group
  std::uint32_t count = 0;             ///< of min_points at least
  std::uint64_t small_groups = 0, small_points = 0;
};

/// Numbers the groups that have min_points, in the order of their first cells.
PointGroups number_groups(const CellGrid& grid, UnionFind& sets, std::uint64_t min_points);

}  // namespace clearway
