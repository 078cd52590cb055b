#include "findings/group/cell_grid.hpp"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <limits>

#include "io/files/parallel_loop.hpp"

namespace clearway {
namespace {

using Range = tbb::blocked_range<std::size_t>;
constexpr std::size_t kGrain = 1 << 16;

/// Points whose q holds the place of their cell until all are sorted: z, y, x.
GridPlace place_of(const GroupedPoint& unmade) {
  return {static_cast<std::uint32_t>(unmade.q[0]), static_cast<std::uint32_t>(unmade.q[1]),
          static_cast<std::uint32_t>(unmade.q[2])};
}

bool before(const GroupedPoint& a, const GroupedPoint& b) {
  const GridPlace at = place_of(a), bt = place_of(b);
  return at != bt ? at < bt : a.row < b.row;
}

}  // namespace

CellGrid::CellGrid(std::span<const QuantumPoint> points, const Neighbourhood& neighbourhood,
                   const QuantumPoint& origin, std::size_t count,
                   const std::function<bool(std::size_t)>& takes)
    : points_(count) {
  const auto& edge = neighbourhood.cell();
  std::atomic<std::size_t> next{0};
  for_each_parallel(Range(0, points.size(), kGrain), [&](const Range& range) {
    std::vector<GroupedPoint> own;
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      if (!takes(i)) continue;
      GroupedPoint& out = own.emplace_back(GroupedPoint{{}, static_cast<std::uint32_t>(i)});
      for (std::size_t k = 0; k < 3; ++k) {
        out.q[2 - k] = static_cast<std::int32_t>(layer_of(points[i].q[k], origin.q[k], edge[k]));
      }
    }
    const std::size_t begin = next.fetch_add(own.size());
    std::ranges::copy(own, points_.begin() + static_cast<std::ptrdiff_t>(begin));
  });
  tbb::parallel_sort(points_.begin(), points_.end(), before);
  const auto begins_cell = [&](std::size_t i) {
    return i == 0 || place_of(points_[i]) != place_of(points_[i - 1]);
  };
  std::size_t cells = 0;
  for (std::size_t i = 0; i < count; ++i) cells += begins_cell(i) ? 1 : 0;
  places_.reserve(cells);
  first_.reserve(cells + 1);
  for (std::size_t i = 0; i < count; ++i) {
    if (!begins_cell(i)) continue;
    places_.push_back(place_of(points_[i]));
    first_.push_back(static_cast<std::uint32_t>(i));
  }
  first_.push_back(static_cast<std::uint32_t>(count));
  for_each_parallel(Range(0, count, kGrain), [&](const Range& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      std::copy_n(points[points_[i].row].q, 3, points_[i].q);
    }
  });
}

namespace {

/// Up to this number, comparing all pairs is cheaper than looking for the nearest points.
constexpr std::size_t kFewPairs = 64;
/// Up to this number, comparing all pairs is cheaper than building trees.
constexpr std::size_t kAllPairs = 4096;

/// A place, which need not be that of a point, in units of the gap.
struct Target {
  double x, y, z;
};

Target target_at(const Neighbourhood& neighbourhood, const GroupedPoint& p) {
  return {p.q[0] * neighbourhood.step(0), p.q[1] * neighbourhood.step(1),
          p.q[2] * neighbourhood.step(2)};
}

Target middle_of(const Neighbourhood& neighbourhood, std::span<const GroupedPoint> points) {
  const Target a = target_at(neighbourhood, points.front());
  const Target b = target_at(neighbourhood, points[points.size() / 2]);
  return {(a.x + b.x) / 2, (a.y + b.y) / 2, (a.z + b.z) / 2};
}

/// The point nearest to a place by double precision, which is a guess.
const GroupedPoint& nearest(const Neighbourhood& neighbourhood,
                            std::span<const GroupedPoint> points, const Target& target) {
  double least = std::numeric_limits<double>::infinity();
  std::size_t best = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Target p = target_at(neighbourhood, points[i]);
    const double x = p.x - target.x, y = p.y - target.y, z = p.z - target.z;
    const double squared = x * x + y * y + z * z;
    if (squared < least) {
      least = squared;
      best = i;
    }
  }
  return points[best];
}

}  // namespace

Nearness compare_cells(const Neighbourhood& neighbourhood, std::span<const GroupedPoint> a,
                       std::span<const GroupedPoint> b) {
  const std::size_t pairs = a.size() * b.size();
  if (pairs > kFewPairs) {
    if (are_neighbours(neighbourhood, a.front(), b.front())) return Nearness::kNear;
    const GroupedPoint* in_a = &nearest(neighbourhood, a, middle_of(neighbourhood, b));
    const GroupedPoint* in_b = &nearest(neighbourhood, b, target_at(neighbourhood, *in_a));
    if (are_neighbours(neighbourhood, *in_a, *in_b)) return Nearness::kNear;
    in_a = &nearest(neighbourhood, a, target_at(neighbourhood, *in_b));
    if (are_neighbours(neighbourhood, *in_a, *in_b)) return Nearness::kNear;
    if (pairs > kAllPairs) return Nearness::kOpen;
  }
  return any_neighbours(neighbourhood, a, b) ? Nearness::kNear : Nearness::kFar;
}

namespace {

using Wide = unsigned __int128;

/// More than the diagonal of all stored integers.
constexpr double kAllSteps = 0x1p33;
/// The longest edge of a grid cell, which holds all stored integers.
constexpr double kLongestEdge = 0x1p32;
constexpr double kWholeWithin = 1e-9;
/// Up to this reach, the squares of three differences that are not above it sum up within 64 bits.
constexpr std::uint64_t kNarrowReach = std::uint64_t{1} << 31;

/// floor(steps^2); a number that is nearly whole is taken as whole.
Wide squared_steps(double steps) {
  const double whole = std::nearbyint(steps);
  if (std::abs(steps - whole) > kWholeWithin) return static_cast<Wide>(steps * steps);
  const auto n = static_cast<std::uint64_t>(whole);
  return Wide{n} * n;
}

std::uint64_t floor_of_root(Wide squared) {
  auto root = static_cast<std::uint64_t>(std::sqrt(static_cast<double>(squared)));
  while (Wide{root} * root > squared) --root;
  while (Wide{root + 1} * (root + 1) <= squared) ++root;
  return root;
}

}  // namespace

Neighbourhood::Neighbourhood(const Quantisation& quantisation, double gap)
    : exact_(quantisation.scale[0] == quantisation.scale[1] &&
             quantisation.scale[1] == quantisation.scale[2]),
      quantisation_(quantisation),
      squared_gap_(gap * gap) {
  if (exact_) {
    squared_ = squared_steps(std::min(gap / quantisation.scale[0], kAllSteps));
    reach_ = floor_of_root(squared_);
    wide_ = reach_ > kNarrowReach;
  }
  choose_cell(gap);
}

void Neighbourhood::choose_cell(double gap) {
  for (std::size_t k = 0; k < 3; ++k) {
    const double most =
        std::min(std::floor(gap / (std::sqrt(3.0) * quantisation_.scale[k])), kLongestEdge);
    cell_[k] = static_cast<std::uint64_t>(most) + 1;
  }
  while (!within(cell_[0] - 1, cell_[1] - 1, cell_[2] - 1)) {
    for (std::uint64_t& edge : cell_) edge = std::max<std::uint64_t>(1, edge - 1);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    std::uint32_t& away = cells_away_[k];
    const auto reached = [&](std::uint32_t cells) {
      const std::uint64_t d = least(cells, k);
      return d <= (std::uint64_t{1} << 32) &&
             within(k == 0 ? d : 0, k == 1 ? d : 0, k == 2 ? d : 0);
    };
    while (reached(away + 1)) ++away;
  }
}

bool Neighbourhood::within_wide(std::uint64_t dx, std::uint64_t dy, std::uint64_t dz) const {
  return Wide{dx} * dx + Wide{dy} * dy + Wide{dz} * dz <= Wide{squared_};
}

}  // namespace clearway
