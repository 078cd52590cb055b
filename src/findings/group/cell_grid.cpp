#include "findings/group/cell_grid.hpp"

#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <limits>

namespace clearway {
namespace {

using Range = tbb::blocked_range<std::size_t>;
constexpr std::size_t kGrain = 1 << 16;

QuantumPoint least_of(std::span<const QuantumPoint> points) {
  constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();
  const auto smaller = [](const QuantumPoint& a, const QuantumPoint& b) {
    return QuantumPoint{
        {std::min(a.q[0], b.q[0]), std::min(a.q[1], b.q[1]), std::min(a.q[2], b.q[2])}};
  };
  return tbb::parallel_reduce(
      Range(0, points.size(), kGrain), QuantumPoint{{kMost, kMost, kMost}},
      [&](const Range& range, QuantumPoint least) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) least = smaller(least, points[i]);
        return least;
      },
      smaller);
}

GridPlace place_of(const GridPoint& unmade) {
  return {static_cast<std::uint32_t>(unmade.q[0]), static_cast<std::uint32_t>(unmade.q[1]),
          static_cast<std::uint32_t>(unmade.q[2])};
}

bool before(const GridPoint& a, const GridPoint& b) {
  const GridPlace at = place_of(a), bt = place_of(b);
  return at != bt ? at < bt : a.row < b.row;
}

}  // namespace

void CellGrid::sort(std::span<const QuantumPoint> points, const Neighbourhood& neighbourhood) {
  origin_ = least_of(points);
  points_.resize(points.size());
  const auto& edge = neighbourhood.cell();
  tbb::parallel_for(Range(0, points.size(), kGrain), [&](const Range& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      GridPoint& out = points_[i];
      for (int k = 0; k < 3; ++k) {
        const auto d = static_cast<std::uint64_t>(std::int64_t{points[i].q[k]} - origin_.q[k]);
        out.q[2 - k] = static_cast<std::int32_t>(d / edge[static_cast<std::size_t>(k)]);
      }
      out.row = static_cast<std::uint32_t>(i);
    }
  });
  tbb::parallel_sort(points_.begin(), points_.end(), before);
}

std::uint64_t CellGrid::count_cells() const {
  return tbb::parallel_reduce(
      Range(0, points_.size(), kGrain), std::uint64_t{0},
      [&](const Range& range, std::uint64_t count) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
          if (i == 0 || place_of(points_[i]) != place_of(points_[i - 1])) ++count;
        }
        return count;
      },
      std::plus<>());
}

void CellGrid::make_cells(std::span<const QuantumPoint> points) {
  const std::uint64_t cells = count_cells();
  places_.reserve(cells);
  first_.reserve(cells + 1);
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const GridPlace place = place_of(points_[i]);
    if (!places_.empty() && place == places_.back()) continue;
    places_.push_back(place);
    first_.push_back(static_cast<std::uint32_t>(i));
  }
  first_.push_back(static_cast<std::uint32_t>(points_.size()));
  tbb::parallel_for(Range(0, points_.size(), kGrain), [&](const Range& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      std::copy_n(points[points_[i].row].q, 3, points_[i].q);
    }
  });
}

}  // namespace clearway
