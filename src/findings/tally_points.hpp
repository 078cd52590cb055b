#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/util/progress.hpp"
#include "findings/group/cell_grid.hpp"
#include "findings/group/point_groups.hpp"
#include "findings/path_stretches.hpp"
#include "findings/tally.hpp"

namespace clearway {

/// The first and the last pose that touch the point of each row.
struct TouchPoses {
  std::span<const std::uint32_t> first, last;
};

/// Tallies of the listed groups. Runs in the caller's arena of oneTBB.
std::vector<Tally> tally_groups(const CellGrid& grid, const PointGroups& groups,
                                const TouchPoses& poses, Progress& progress);

/// Tallies of the small groups. Runs in the caller's arena of oneTBB.
std::vector<Tally> tally_small_groups(const CellGrid& grid, const PointGroups& groups,
                                      const TouchPoses& poses, Progress& progress);

/// The parts that groups are cut into. The parts of a group are consecutive, one for each stretch
/// of the path from the group's first to its last pose, and may be empty.
struct GroupParts {
  /// The first part of each group, and at the end the number of all parts.
  std::vector<std::uint64_t> first;
  /// The stretch of each group's first part.
  std::vector<std::uint32_t> stretch;
  std::vector<bool> is_cut;  ///< whether each group is cut

  std::uint64_t count() const { return first.back(); }
};

/// Tallies of the parts. part_of_row becomes for each row the index of its part + 1, and stays as
/// it is, namely 0, for rows of small groups. There have to be fewer than 2^32 - 1 parts.
std::vector<Tally> tally_parts(const CellGrid& grid, const PointGroups& groups,
                               const GroupParts& parts, const PathStretches& stretches,
                               const TouchPoses& poses, std::span<std::uint32_t> part_of_row,
                               Progress& progress);

}  // namespace clearway
