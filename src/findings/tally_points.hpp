#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/geometry/quantisation.hpp"
#include "core/util/progress.hpp"
#include "findings/group/cell_grid.hpp"
#include "findings/group/point_groups.hpp"
#include "findings/touched_first.hpp"

namespace clearway {

/// Sums over a set of points, in integers, so that they are the same in any order.
struct Tally {
  std::uint64_t points = 0;
  std::uint32_t first_row = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t first_pose = std::numeric_limits<std::uint32_t>::max();
  /// The smallest row of a point with that first pose.
  std::uint32_t first_touched = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t latest_first_pose = 0;
  std::uint32_t last_pose = 0;
  QuantumBox box{{kMost, kMost, kMost}, {kLeast, kLeast, kLeast}};
  __int128 sum[3]{};

  void add(const GroupedPoint& p, std::uint32_t first, std::uint32_t last) {
    ++points;
    first_row = std::min(first_row, p.row);
    add_first(first, p.row);
    latest_first_pose = std::max(latest_first_pose, first);
    last_pose = std::max(last_pose, last);
    box.extend(p.q);
    for (int k = 0; k < 3; ++k) sum[k] += p.q[k];
  }

  void add(const Tally& other) {
    points += other.points;
    first_row = std::min(first_row, other.first_row);
    add_first(other.first_pose, other.first_touched);
    latest_first_pose = std::max(latest_first_pose, other.latest_first_pose);
    last_pose = std::max(last_pose, other.last_pose);
    box = box.united(other.box);
    for (int k = 0; k < 3; ++k) sum[k] += other.sum[k];
  }

 private:
  /// Takes a first pose and its row; of equal poses the smallest row.
  void add_first(std::uint32_t pose, std::uint32_t row) {
    first_touched = pose < first_pose    ? row
                    : pose == first_pose ? std::min(first_touched, row)
                                         : first_touched;
    first_pose = std::min(first_pose, pose);
  }

  static constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();
  static constexpr std::int32_t kLeast = std::numeric_limits<std::int32_t>::min();
};

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
