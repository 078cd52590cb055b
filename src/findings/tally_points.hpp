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

/// The first and the last pose that touch each row's point.
struct TouchPoses {
  std::span<const std::uint32_t> first, last;
};

/// Sums of each listed group. Runs in the caller's arena of oneTBB.
std::vector<Tally> tally_groups(const CellGrid& grid, const PointGroups& groups,
                                const TouchPoses& poses, Progress& progress);

/// Sums of each small group.
std::vector<Tally> tally_small_groups(const CellGrid& grid, const PointGroups& groups,
                                      const TouchPoses& poses, Progress& progress);

/// The parts that groups are cut into: consecutive ones for each group, one for each stretch of the
/// path from its first to its last pose. Parts may be empty.
struct GroupParts {
  std::vector<std::uint64_t> first;    ///< of each group, and their end
  std::vector<std::uint32_t> stretch;  ///< of each group, the one of its first part
  std::vector<bool> is_cut;            ///< of each group

  std::uint64_t count() const { return first.back(); }
};

/// Sums of each part; part_of_row becomes the part's number + 1 of each row, 0 for rows of small
/// groups. Fewer than 2^32 - 1 parts.
std::vector<Tally> tally_parts(const CellGrid& grid, const PointGroups& groups,
                               const GroupParts& parts, const PathStretches& stretches,
                               const TouchPoses& poses, std::span<std::uint32_t> part_of_row,
                               Progress& progress);

}  // namespace clearway
