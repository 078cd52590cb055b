#include "findings/group/join_cells.hpp"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "core/util/tsan_annotations.hpp"
#include "findings/group/near_cells.hpp"
#include "findings/group/point_tree.hpp"

namespace clearway {
namespace {

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
    const ParallelScope scope;
    const auto decide_pair = piece_of(scope, [&](std::size_t i) {
      const auto [a, b] = pairs_[i];
      if (progress.stop_requested() || sets_.together(a, b)) return;
      if (PointTree::any_neighbours(neighbourhood_, tree(a), tree(b))) sets_.unite(a, b);
    });
    scope.begin();
    tbb::parallel_for(std::size_t{0}, pairs_.size(), decide_pair);
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
    const ParallelScope scope;
    const auto make = piece_of(scope, [&](std::size_t i) {
      if (!progress.stop_requested()) trees_[i].emplace(grid_.points(cells_[i]), neighbourhood_);
    });
    scope.begin();
    tbb::parallel_for(std::size_t{0}, cells_.size(), make);
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
  const ParallelScope scope;
  const auto look = piece_of(scope, [&](const CellRange& range) {
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
  scope.begin();
  tbb::parallel_for(CellRange(0, grid.cells(), kCellGrain), look);
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

}  // namespace clearway
