#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/util/progress.hpp"
#include "findings/group/cell_grid.hpp"
#include "findings/point_blocks.hpp"

namespace clearway {

/// The groups of points that hang together.
struct PointGroups {
  /// A small group has a number of its own, from 0, together with this bit.
  static constexpr std::uint32_t kSmall = std::uint32_t{1} << 31;
  static bool is_small(std::uint32_t group) { return (group & kSmall) != 0; }

  /// The group of each point: a number below count, or that of a small group.
  std::vector<std::uint32_t> of_point;
  std::uint32_t count = 0;  ///< number of groups with at least min_points points
  std::uint64_t small_groups = 0, small_points = 0;
};

/// The most bytes that a point takes while it is grouped together with those around it: in the
/// grid, and in a tree and in lists of cells that a first look left open.
inline constexpr std::uint64_t kBytesOfPointAtWork =
    CellGrid::kBytesOfPoint + sizeof(QuantumPoint) + PointBlocks::kBytesOfPoint;

/// How many points may be at work at the same time.
struct GroupingLimit {
  std::uint64_t points = ~std::uint64_t{0};
  /// Called where a single layer of the grid has more of them, to refuse that.
  std::function<void(std::uint64_t points)> refuse = {};
};

/// Finds the groups of points that are neighbours, directly or through others. Those that have at
/// least min_points are numbered in the order of their first points, and the small ones likewise.
/// points: fewer than 2^32 - 1. only: where given, points for which it is false are left alone.
/// Runs in the caller's arena of oneTBB. Throws Interrupted.
PointGroups group_points(std::span<const QuantumPoint> points, const Neighbourhood& neighbourhood,
                         std::uint64_t min_points, Progress& progress,
                         const GroupingLimit& limit = {}, const std::vector<bool>* only = nullptr);

}  // namespace clearway
