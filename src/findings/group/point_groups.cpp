#include "findings/group/point_groups.hpp"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/geometry/quantisation.hpp"
#include "findings/group/cell_grid.hpp"
#include "io/files/parallel_loop.hpp"

namespace clearway {
namespace {

/// A k-d tree over the points of a cell, which it puts into its own order.
class PointTree {
 public:
  static constexpr std::size_t kLeafPoints = 16;
  /// The most bytes that a tree takes for each point.
  static constexpr std::uint64_t kBytesOfPoint = 10;

  /// neighbourhood: gives the scale of each axis, by which the axis to split is chosen. The points
  /// outlive the tree.
  PointTree(std::span<GroupedPoint> points, const Neighbourhood& neighbourhood);

  /// Whether a point of one tree has a neighbour in the other. Pairs of nodes that are surely near
  /// or surely far are not opened.
  static bool any_neighbours(const Neighbourhood& neighbourhood, const PointTree& a,
                             const PointTree& b) {
    return near(neighbourhood, a, a.nodes_.front(), b, b.nodes_.front());
  }

 private:
  struct Node {
    QuantumBox box;
    std::uint32_t first, last;
    /// The right child; the left one is the next node. 0 for a leaf.
    std::uint32_t right;
  };
  static bool near(const Neighbourhood& neighbourhood, const PointTree& a, const Node& in_a,
                   const PointTree& b, const Node& in_b);
  void build(std::uint32_t first, std::uint32_t last, const Neighbourhood& neighbourhood);
  std::span<const GroupedPoint> points(const Node& node) const;
  const Node& left(const Node& node) const { return *(&node + 1); }
  const Node& right(const Node& node) const { return nodes_[node.right]; }

  std::span<GroupedPoint> points_;
  std::vector<Node> nodes_;
};

QuantumBox box_of_points(std::span<const GroupedPoint> points) {
  QuantumBox box{{points[0].q[0], points[0].q[1], points[0].q[2]},
                 {points[0].q[0], points[0].q[1], points[0].q[2]}};
  for (const GroupedPoint& p : points) {
    box.extend(p.q);
  }
  return box;
}

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

bool is_one_place(const QuantumBox& box) { return std::equal(box.lo, box.lo + 3, box.hi); }

PointTree::PointTree(std::span<GroupedPoint> points, const Neighbourhood& neighbourhood)
    : points_(points) {
  nodes_.reserve(points.size() * 4 / kLeafPoints + 1);
  build(0, static_cast<std::uint32_t>(points.size()), neighbourhood);
}

void PointTree::build(std::uint32_t first, std::uint32_t last, const Neighbourhood& neighbourhood) {
  const std::size_t self = nodes_.size();
  const QuantumBox box = box_of_points(points_.subspan(first, last - first));
  nodes_.push_back({box, first, last, 0});
  if (last - first <= kLeafPoints || is_one_place(box)) return;
  int axis = 0;
  for (int k = 1; k < 3; ++k) {
    if (extent(box, neighbourhood, k) > extent(box, neighbourhood, axis)) axis = k;
  }
  const std::uint32_t middle = first + (last - first) / 2;
  std::nth_element(points_.begin() + first, points_.begin() + middle, points_.begin() + last,
                   [axis](const GroupedPoint& a, const GroupedPoint& b) {
                     return a.q[axis] != b.q[axis] ? a.q[axis] < b.q[axis] : a.row < b.row;
                   });
  build(first, middle, neighbourhood);
  nodes_[self].right = static_cast<std::uint32_t>(nodes_.size());
  build(middle, last, neighbourhood);
}

/// The points of a leaf, where points that are all at the same place count as one.
std::span<const GroupedPoint> PointTree::points(const Node& node) const {
  return points_.subspan(node.first, is_one_place(node.box) ? 1 : node.last - node.first);
}

bool PointTree::near(const Neighbourhood& neighbourhood, const PointTree& a, const Node& in_a,
                     const PointTree& b, const Node& in_b) {
  const QuantumBox &box_a = in_a.box, &box_b = in_b.box;
  if (!neighbourhood.within(least_difference(box_a, box_b, 0), least_difference(box_a, box_b, 1),
                            least_difference(box_a, box_b, 2))) {
    return false;
  }
  if (neighbourhood.within(greatest_difference(box_a, box_b, 0),
                           greatest_difference(box_a, box_b, 1),
                           greatest_difference(box_a, box_b, 2))) {
    return true;
  }
  if (in_a.right == 0 && in_b.right == 0) {
    return clearway::any_neighbours(neighbourhood, a.points(in_a), b.points(in_b));
  }
  const bool open_a =
      in_b.right == 0 || (in_a.right != 0 && greatest_extent(box_a, neighbourhood) >=
                                                 greatest_extent(box_b, neighbourhood));
  if (open_a) {
    return near(neighbourhood, a, a.left(in_a), b, in_b) ||
           near(neighbourhood, a, a.right(in_a), b, in_b);
  }
  return near(neighbourhood, a, in_a, b, b.left(in_b)) ||
         near(neighbourhood, a, in_a, b, b.right(in_b));
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

/// Decides the pairs of cells that a first look left open, with a tree for each of their cells.
class OpenPairs {
 public:
  OpenPairs(CellGrid& grid, const Neighbourhood& neighbourhood, UnionFind& sets,
            std::vector<Pair> pairs)
      : grid_(grid), neighbourhood_(neighbourhood), sets_(sets), pairs_(std::move(pairs)) {
    std::erase_if(pairs_, [&](const Pair& p) { return sets_.together(p.first, p.second); });
  }

  void decide(const Progress& progress) {
    make_trees(progress);
    for_each_parallel(pairs_.size(), [&](std::size_t i) {
      const auto [a, b] = pairs_[i];
      if (progress.stop_requested() || sets_.together(a, b)) return;
      if (PointTree::any_neighbours(neighbourhood_, tree(a), tree(b))) sets_.unite(a, b);
    });
  }

 private:
  void make_trees(const Progress& progress) {
    for (const auto& [a, b] : pairs_) {
      cells_.push_back(a);
      cells_.push_back(b);
    }
    std::sort(cells_.begin(), cells_.end());
    cells_.erase(std::unique(cells_.begin(), cells_.end()), cells_.end());
    trees_.resize(cells_.size());
    for_each_parallel(cells_.size(), [&](std::size_t i) {
      if (!progress.stop_requested()) trees_[i].emplace(grid_.points(cells_[i]), neighbourhood_);
    });
    throw_if_stopped(progress);
  }
  const PointTree& tree(std::uint32_t cell) const {
    const auto at = std::lower_bound(cells_.begin(), cells_.end(), cell);
    return *trees_[static_cast<std::size_t>(at - cells_.begin())];
  }

  CellGrid& grid_;
  const Neighbourhood& neighbourhood_;
  UnionFind& sets_;
  std::vector<Pair> pairs_;
  std::vector<std::uint32_t> cells_;
  std::vector<std::optional<PointTree>> trees_;  ///< trees of cells_
};

/// Compares each cell with those of one row, and unites cells that hold neighbours. Returns the
/// pairs that stay open.
std::vector<Pair> look_along(const CellGrid& grid, const Neighbourhood& neighbourhood,
                             UnionFind& sets, const RowStep& step, Progress& progress) {
  tbb::enumerable_thread_specific<std::vector<Pair>> open;
  for_each_parallel(CellRange(0, grid.cells(), kCellGrain), [&](const CellRange& range) {
    if (progress.stop_requested()) return;
    RowWalk walk(grid, neighbourhood, step);
    for (std::uint32_t cell = range.begin(); cell != range.end(); ++cell) {
      walk.visit(cell, [&](std::uint32_t other) {
        if (sets.together(cell, other)) return;
        switch (compare_cells(neighbourhood, grid.points(cell), grid.points(other))) {
          case Nearness::kNear:
            return sets.unite(cell, other);
          case Nearness::kOpen:
            return open.local().emplace_back(cell, other), void();
          case Nearness::kFar:
            return;
        }
      });
    }
    progress.advance(range.size());
  });
  throw_if_stopped(progress);
  std::vector<Pair> all;
  for (const std::vector<Pair>& some : open) all.insert(all.end(), some.begin(), some.end());
  return all;
}

}  // namespace

void join_cells(CellGrid& grid, const Neighbourhood& neighbourhood, UnionFind& sets,
                Progress& progress) {
  const std::vector<RowStep> rows = rows_in_reach(neighbourhood);
  progress.begin("group", rows.size() * grid.cells(), "cells");
  for (const RowStep& step : rows) {
    OpenPairs open(grid, neighbourhood, sets,
                   look_along(grid, neighbourhood, sets, step, progress));
    open.decide(progress);
    throw_if_stopped(progress);
  }
  progress.end();
}

PointGroups number_groups(const CellGrid& grid, UnionFind& sets, std::uint64_t min_points) {
  PointGroups out;
  // A root is the first cell of its set, so it gets its number before the set's other cells ask for
  // it.
  std::vector<std::uint32_t> points(grid.cells());  // at the index of a root, the points of its set
  for (std::uint32_t cell = 0; cell < grid.cells(); ++cell) {
    points[sets.find(cell)] += static_cast<std::uint32_t>(grid.points(cell).size());
  }
  out.of_cell.resize(grid.cells());
  for (std::uint32_t cell = 0; cell < grid.cells(); ++cell) {
    const std::uint32_t root = sets.find(cell);
    if (root != cell) {
      out.of_cell[cell] = out.of_cell[root];
    } else if (points[cell] >= min_points) {
      out.of_cell[cell] = out.count++;
    } else {
      out.of_cell[cell] = PointGroups::kSmall | static_cast<std::uint32_t>(out.small_groups++);
      out.small_points += points[cell];
    }
  }
  return out;
}

}  // namespace clearway
