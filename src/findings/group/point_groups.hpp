#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/util/progress.hpp"
#include "findings/group/cell_grid.hpp"
#include "findings/group/union_find.hpp"

namespace clearway {

/// The groups of a grid's points. Each group is a set of cells.
struct PointGroups {
  /// A small group has a number of its own, from 0, together with this bit.
  static constexpr std::uint32_t kSmall = std::uint32_t{1} << 31;
  static bool is_small(std::uint32_t group) { return (group & kSmall) != 0; }

  /// The group of each cell: a number below count, or that of a small group.
  std::vector<std::uint32_t> of_cell;
  std::uint32_t count = 0;  ///< number of groups with at least min_points points
  std::uint64_t small_groups = 0, small_points = 0;
};

/// Numbers the groups that have at least min_points points, in the order of their first cells, and
/// the small groups likewise.
PointGroups number_groups(const CellGrid& grid, UnionFind& sets, std::uint64_t min_points);

}  // namespace clearway
