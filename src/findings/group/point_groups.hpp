#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "core/util/progress.hpp"
#include "findings/group/cell_grid.hpp"

namespace clearway {

/// Disjoint sets of numbers that several threads may unite at the same time. The root of a set is
/// its smallest number, in whatever order sets are united. Source: Anderson and Woll, Wait-free
/// parallel algorithms for the union-find problem, 1991.
class UnionFind {
 public:
  explicit UnionFind(std::uint32_t count) : parent_(count) {
    for (std::uint32_t i = 0; i < count; ++i) parent_[i].store(i, kRelaxed);
  }

  std::uint32_t find(std::uint32_t i) {
    for (;;) {
      std::uint32_t above = parent_[i].load(kRelaxed);
      if (above == i) return i;
      const std::uint32_t higher = parent_[above].load(kRelaxed);
      if (higher != above) parent_[i].compare_exchange_weak(above, higher, kRelaxed);
      i = higher;
    }
  }

  /// Whether two numbers are in one set. True is always right; false may be wrong while other
  /// threads unite sets.
  bool together(std::uint32_t a, std::uint32_t b) { return find(a) == find(b); }

  void unite(std::uint32_t a, std::uint32_t b) {
    for (;;) {
      a = find(a);
      b = find(b);
      if (a == b) return;
      if (a > b) std::swap(a, b);
      std::uint32_t root = b;
      if (parent_[b].compare_exchange_strong(root, a, kRelaxed)) return;
    }
  }

 private:
  // Parents only ever change to smaller numbers of the same set, and no other memory depends on
  // them.
  static constexpr auto kRelaxed = std::memory_order_relaxed;
  std::vector<std::atomic<std::uint32_t>> parent_;
};

/// The most bytes that trees and lists of open pairs take for a point.
inline constexpr std::uint64_t kJoinBytesOfPoint = 20;

/// Unites the cells that hold neighbours, directly or through others. Points may change their order
/// within a cell. Runs in the caller's arena of oneTBB. Throws Interrupted.
void join_cells(CellGrid& grid, const Neighbourhood& neighbourhood, UnionFind& sets,
                Progress& progress);

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
