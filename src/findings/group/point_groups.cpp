#include "findings/group/point_groups.hpp"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <numeric>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/geometry/quantisation.hpp"
#include "findings/group/cell_grid.hpp"
#include "io/files/parallel_loop.hpp"

namespace clearway {
namespace {

/// Disjoint sets of numbers that several threads may unite at the same time. The root of a set is
/// its smallest number, in whatever order sets are united. Source: Anderson and Woll, Wait-free
/// parallel algorithms for the union-find problem, 1991.
class UnionFind {
 public:
  explicit UnionFind(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), 0U);
  }

  std::uint32_t find(std::uint32_t i) {
    for (;;) {
      std::uint32_t above = parent(i).load(kRelaxed);
      if (above == i) return i;
      const std::uint32_t higher = parent(above).load(kRelaxed);
      if (higher != above) parent(i).compare_exchange_weak(above, higher, kRelaxed);
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
      if (parent(b).compare_exchange_strong(root, a, kRelaxed)) return;
    }
  }

  /// The root of each number, for which the sets are given up.
  std::vector<std::uint32_t> take_roots() {
    for (std::uint32_t& above : parent_) above = parent_[above];  // which is complete already
    return std::move(parent_);
  }

 private:
  // Parents only ever change to smaller numbers of the same set, and no other memory depends on
  // them.
  static constexpr auto kRelaxed = std::memory_order_relaxed;
  std::atomic_ref<std::uint32_t> parent(std::uint32_t i) {
    return std::atomic_ref<std::uint32_t>(parent_[i]);
  }
  std::vector<std::uint32_t> parent_;
};

double extent(const QuantumBox& box, const Neighbourhood& neighbourhood, int axis) {
  return (static_cast<double>(box.hi[axis]) - box.lo[axis]) * neighbourhood.step(axis);
}

double greatest_extent(const QuantumBox& box, const Neighbourhood& neighbourhood) {
  return std::max({extent(box, neighbourhood, 0), extent(box, neighbourhood, 1),
                   extent(box, neighbourhood, 2)});
}

/// The least difference on axis k between a point of one box and a point of the other.
std::uint64_t least_difference(const QuantumBox& a, const QuantumBox& b, int k) {
  if (a.hi[k] < b.lo[k]) return difference_of(a.hi[k], b.lo[k]);
  return b.hi[k] < a.lo[k] ? difference_of(b.hi[k], a.lo[k]) : 0;
}

std::uint64_t greatest_difference(const QuantumBox& a, const QuantumBox& b, int k) {
  return std::max(difference_of(a.lo[k], b.hi[k]), difference_of(a.hi[k], b.lo[k]));
}

/// Whether a point of one node has a neighbour in the other. Pairs of nodes that are surely near or
/// surely far are not opened.
bool near(const Neighbourhood& neighbourhood, const PointBlocks& a, std::uint32_t in_a,
          const PointBlocks& b, std::uint32_t in_b) {
  const QuantumBox &box_a = a.node(in_a).box, &box_b = b.node(in_b).box;
  if (!neighbourhood.within(least_difference(box_a, box_b, 0), least_difference(box_a, box_b, 1),
                            least_difference(box_a, box_b, 2))) {
    return false;
  }
  if (neighbourhood.within(greatest_difference(box_a, box_b, 0),
                           greatest_difference(box_a, box_b, 1),
                           greatest_difference(box_a, box_b, 2))) {
    return true;
  }
  if (a.is_block(in_a) && b.is_block(in_b)) {
    return any_neighbours(neighbourhood, a.points(in_a), b.points(in_b));
  }
  const bool open_a =
      b.is_block(in_b) || (!a.is_block(in_a) && greatest_extent(box_a, neighbourhood) >=
                                                    greatest_extent(box_b, neighbourhood));
  if (open_a) {
    return near(neighbourhood, a, 2 * in_a + 1, b, in_b) ||
           near(neighbourhood, a, 2 * in_a + 2, b, in_b);
  }
  return near(neighbourhood, a, in_a, b, 2 * in_b + 1) ||
         near(neighbourhood, a, in_a, b, 2 * in_b + 2);
}

using CellRange = tbb::blocked_range<std::uint32_t>;
using Pair = std::pair<std::uint32_t, std::uint32_t>;
constexpr std::uint32_t kCellGrain = 16;

/// A row of cells along x, as seen from another row. Of two rows that see each other only one has
/// the step.
struct RowStep {
  std::int64_t y, z;
};

/// The rows that may hold neighbours. Near rows come first, because what they join need not be
/// looked at again.
std::vector<RowStep> rows_in_reach(const Neighbourhood& neighbourhood) {
  const std::int64_t most_y = neighbourhood.cells_away()[1];
  const std::int64_t most_z = neighbourhood.cells_away()[2];
  std::vector<RowStep> rows;
  for (std::int64_t z = 0; z <= most_z; ++z) {
    for (std::int64_t y = z == 0 ? 0 : -most_y; y <= most_y; ++y) {
      if (neighbourhood.cells_within(0, static_cast<std::uint32_t>(std::abs(y)),
                                     static_cast<std::uint32_t>(z))) {
        rows.push_back({y, z});
      }
    }
  }
  std::stable_sort(rows.begin(), rows.end(), [](const RowStep& a, const RowStep& b) {
    return a.y * a.y + a.z * a.z < b.y * b.y + b.z * b.z;
  });
  return rows;
}

/// Visits each cell of a row that is within reach of a cell. The cells have to be asked for in
/// their order.
class RowWalk {
 public:
  RowWalk(const CellGrid& grid, const Neighbourhood& neighbourhood, const RowStep& step)
      : places_(grid.places()), neighbourhood_(neighbourhood), step_(step) {}

  template <typename Visit>
  void visit(std::uint32_t cell, Visit visit) {
    const GridPlace& from = places_[cell];
    const std::int64_t y = from.y + step_.y, z = from.z + step_.z;
    constexpr std::int64_t kMost = 0xffff'ffff;
    if (y < 0 || y > kMost || z > kMost) return;
    const std::uint32_t away = neighbourhood_.cells_away()[0];
    const bool own = step_.y == 0 && step_.z == 0;
    const GridPlace first{static_cast<std::uint32_t>(z), static_cast<std::uint32_t>(y),
                          own ? from.x : from.x - std::min(away, from.x)};
    if (!started_) at_ = std::lower_bound(places_.begin(), places_.end(), first) - places_.begin();
    started_ = true;
    while (at_ < places_.size() && places_[at_] < first) ++at_;
    for (std::size_t i = own ? cell + 1 : at_; i < places_.size(); ++i) {
      const GridPlace& to = places_[i];
      if (to.z != first.z || to.y != first.y) return;
      const std::uint32_t apart = to.x > from.x ? to.x - from.x : from.x - to.x;
      if (to.x > from.x && apart > away) return;
      if (neighbourhood_.cells_within(apart, static_cast<std::uint32_t>(std::abs(step_.y)),
                                      static_cast<std::uint32_t>(step_.z))) {
        visit(static_cast<std::uint32_t>(i));
      }
    }
  }

 private:
  std::span<const GridPlace> places_;
  const Neighbourhood& neighbourhood_;
  const RowStep step_;
  std::size_t at_ = 0;
  bool started_ = false;
};

/// The points of a cell in a tree of their own.
class CellTree {
 public:
  CellTree(std::span<const GroupedPoint> points, const Quantisation& quantisation)
      : points_(copied(points)), blocks_(quantisation, points_) {}
  CellTree(const CellTree&) = delete;
  CellTree& operator=(const CellTree&) = delete;

  const PointBlocks& blocks() const { return blocks_; }

 private:
  static std::vector<QuantumPoint> copied(std::span<const GroupedPoint> points) {
    std::vector<QuantumPoint> out(points.size());
    for (std::size_t i = 0; i < out.size(); ++i) std::ranges::copy(points[i].q, out[i].q);
    return out;
  }

  std::vector<QuantumPoint> points_;
  PointBlocks blocks_;
};

/// Unites the points of some layers of the grid that are neighbours, directly or through others.
class LayerGroups {
 public:
  LayerGroups(const CellGrid& grid, const Neighbourhood& neighbourhood, UnionFind& sets,
              Progress& progress)
      : grid_(grid), neighbourhood_(neighbourhood), sets_(sets), progress_(progress) {}

  void unite() {
    for_each_parallel(CellRange(0, grid_.cells(), kCellGrain), [&](const CellRange& range) {
      for (std::uint32_t cell = range.begin(); cell != range.end(); ++cell) {
        for (const GroupedPoint& p : grid_.points(cell)) sets_.unite(first_of(cell), p.row);
      }
    });
    const std::vector<RowStep> rows = rows_in_reach(neighbourhood_);
    progress_.begin("group", rows.size() * grid_.cells(), "cells");
    for (const RowStep& step : rows) decide(look_along(step));
    progress_.end();
  }

 private:
  /// The point that stands for all of its cell.
  std::uint32_t first_of(std::uint32_t cell) const { return grid_.points(cell).front().row; }
  bool together(std::uint32_t a, std::uint32_t b) {
    return sets_.together(first_of(a), first_of(b));
  }

  /// Compares each cell with those of one row, and unites cells that hold neighbours. Returns the
  /// pairs that stay open.
  std::vector<Pair> look_along(const RowStep& step) {
    tbb::enumerable_thread_specific<std::vector<Pair>> open;
    for_each_parallel(CellRange(0, grid_.cells(), kCellGrain), [&](const CellRange& range) {
      if (progress_.stop_requested()) return;
      RowWalk walk(grid_, neighbourhood_, step);
      for (std::uint32_t cell = range.begin(); cell != range.end(); ++cell) {
        walk.visit(cell, [&](std::uint32_t other) {
          if (together(cell, other)) return;
          const Nearness found =
              compare_cells(neighbourhood_, grid_.points(cell), grid_.points(other));
          if (found == Nearness::kNear) sets_.unite(first_of(cell), first_of(other));
          if (found == Nearness::kOpen) open.local().emplace_back(cell, other);
        });
      }
      progress_.advance(range.size());
    });
    throw_if_stopped(progress_);
    std::vector<Pair> all;
    for (const std::vector<Pair>& some : open) all.insert(all.end(), some.begin(), some.end());
    return all;
  }

  /// Decides the pairs of cells that a first look left open, with a tree for each of their cells.
  void decide(std::vector<Pair> pairs) {
    std::erase_if(pairs, [&](const Pair& p) { return together(p.first, p.second); });
    std::vector<std::uint32_t> cells;
    for (const auto& [a, b] : pairs) cells.insert(cells.end(), {a, b});
    std::ranges::sort(cells);
    cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
    std::vector<std::optional<CellTree>> trees(cells.size());
    for_each_parallel(cells.size(), [&](std::size_t i) {
      if (progress_.stop_requested()) return;
      trees[i].emplace(grid_.points(cells[i]), neighbourhood_.quantisation());
    });
    throw_if_stopped(progress_);
    const auto tree_of = [&](std::uint32_t cell) -> const PointBlocks& {
      const auto at = std::ranges::lower_bound(cells, cell) - cells.begin();
      return trees[static_cast<std::size_t>(at)]->blocks();
    };
    for_each_parallel(pairs.size(), [&](std::size_t i) {
      const auto [a, b] = pairs[i];
      if (progress_.stop_requested() || together(a, b)) return;
      if (near(neighbourhood_, tree_of(a), 0, tree_of(b), 0)) {
        sets_.unite(first_of(a), first_of(b));
      }
    });
    throw_if_stopped(progress_);
  }

  const CellGrid& grid_;
  const Neighbourhood& neighbourhood_;
  UnionFind& sets_;
  Progress& progress_;
};

/// Groups the points layer by layer, as many layers together as may be at work at the same time.
class GroupFinder {
 public:
  GroupFinder(std::span<const QuantumPoint> points, const Neighbourhood& neighbourhood,
              const GroupingLimit& limit, const std::vector<bool>* only, Progress& progress)
      : points_(points),
        neighbourhood_(neighbourhood),
        limit_(limit),
        only_(only),
        progress_(progress),
        sets_(points.size()) {}

  std::vector<std::uint32_t> run() {
    if (points_.empty()) return {};
    const QuantumBox box = box_of(points_);
    std::ranges::copy(box.lo, origin_.q);
    std::uint64_t most = 0;
    for (int k = 0; k < 3; ++k) {
      const std::uint64_t layers = layer_at(box.hi[k], k) + 1;
      if (layers > most) axis_ = k;
      most = std::max(most, layers);
    }
    group(0, most);
    return sets_.take_roots();
  }

 private:
  std::uint64_t layer_at(std::int32_t q, int axis) const {
    return layer_of(q, origin_.q[axis], neighbourhood_.cell()[static_cast<std::size_t>(axis)]);
  }

  /// Groups the points of some layers with each other, and with those of the layers before them
  /// that can hold neighbours.
  void group(std::uint64_t first, std::uint64_t end) {
    const auto k = static_cast<std::size_t>(axis_);
    const std::uint64_t away = std::min<std::uint64_t>(first, neighbourhood_.cells_away()[k]);
    const auto begin_of = [&](std::uint64_t layer) {
      return origin_.q[k] + static_cast<std::int64_t>(layer * neighbourhood_.cell()[k]);
    };
    const auto takes = [this, k, from = begin_of(first - away), to = begin_of(end)](std::size_t i) {
      const std::int64_t q = points_[i].q[k];
      return q >= from && q < to && (only_ == nullptr || (*only_)[i]);
    };
    std::size_t count = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) count += takes(i) ? 1 : 0;
    if (count > limit_.points && end - first > 1) {
      const std::uint64_t middle = first + (end - first) / 2;
      group(first, middle);
      return group(middle, end);
    }
    if (count > limit_.points) limit_.refuse(count);
    if (count == 0) return;
    const CellGrid grid(points_, neighbourhood_, origin_, count, takes);
    LayerGroups(grid, neighbourhood_, sets_, progress_).unite();
  }

  std::span<const QuantumPoint> points_;
  const Neighbourhood& neighbourhood_;
  const GroupingLimit& limit_;
  const std::vector<bool>* only_;
  Progress& progress_;
  QuantumPoint origin_{};
  int axis_ = 0;
  UnionFind sets_;
};

}  // namespace

PointGroups group_points(std::span<const QuantumPoint> points, const Neighbourhood& neighbourhood,
                         std::uint64_t min_points, Progress& progress, const GroupingLimit& limit,
                         const std::vector<bool>* only) {
  PointGroups out;
  out.of_point = GroupFinder(points, neighbourhood, limit, only, progress).run();
  std::vector<std::uint32_t> size(points.size());  // at the root of each group
  for (const std::uint32_t root : out.of_point) ++size[root];
  // A root is the first point of its group, so it has its number before the others ask for it.
  for (std::uint32_t i = 0; i < size.size(); ++i) {
    std::uint32_t& group = out.of_point[i];
    if (group != i) {
      group = out.of_point[group];
    } else if (size[i] >= min_points) {
      group = out.count++;
    } else {
      group = PointGroups::kSmall | static_cast<std::uint32_t>(out.small_groups++);
      out.small_points += size[i];
    }
  }
  return out;
}

}  // namespace clearway
