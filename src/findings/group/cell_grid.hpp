#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <tuple>
#include <vector>

#include "core/geometry/quantisation.hpp"
#include "findings/point_blocks.hpp"

namespace clearway {

/// Which differences of stored integers are at most the gap (docs/design/findings.md, 4). It is
/// decided in integers where the scales of the three axes are equal, otherwise in double precision.
class Neighbourhood {
 public:
  /// gap: the greatest distance between neighbours; above 0, in the unit of the scale.
  Neighbourhood(const Quantisation& quantisation, double gap);

  /// Whether two points with these differences are neighbours. Differences are from 0 to 2^32. What
  /// holds for some differences also holds for smaller ones.
  bool within(std::uint64_t dx, std::uint64_t dy, std::uint64_t dz) const {
    if (exact_) {
      if (wide_) return within_wide(dx, dy, dz);
      if (dx > reach_ || dy > reach_ || dz > reach_) return false;
      return dx * dx + dy * dy + dz * dz <= static_cast<std::uint64_t>(squared_);
    }
    const double x = static_cast<double>(dx) * step(0);
    const double y = static_cast<double>(dy) * step(1);
    const double z = static_cast<double>(dz) * step(2);
    return x * x + y * y + z * z <= squared_gap_;
  }

  /// The edges of a grid cell in quanta, long but such that all points of a cell are neighbours.
  const std::array<std::uint64_t, 3>& cell() const { return cell_; }
  /// How many cells away a neighbour of a point can lie, on each axis.
  const std::array<std::uint32_t, 3>& cells_away() const { return cells_away_; }
  /// Whether cells that are this many cells apart can hold neighbours.
  bool cells_within(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    return within(least(x, 0), least(y, 1), least(z, 2));
  }

  const Quantisation& quantisation() const { return quantisation_; }
  /// The scale of an axis, in the unit of the gap; for guesses only.
  double step(int axis) const { return quantisation_.scale[axis]; }

 private:
  void choose_cell(double gap);
  bool within_wide(std::uint64_t dx, std::uint64_t dy, std::uint64_t dz) const;
  /// The least difference, in quanta along an axis, between points of two cells whose indices on
  /// that axis differ by `cells`.
  std::uint64_t least(std::uint32_t cells, std::size_t axis) const {
    return cells == 0 ? 0 : (cells - 1) * cell_[axis] + 1;
  }

  bool exact_, wide_ = false;
  unsigned __int128 squared_ = 0;  ///< the greatest squared difference
  /// The greatest difference on one axis that is within the gap; not used where `wide_`.
  std::uint64_t reach_ = 0;
  Quantisation quantisation_;
  double squared_gap_ = 0;
  std::array<std::uint64_t, 3> cell_{};
  std::array<std::uint32_t, 3> cells_away_{};
};

/// A point and its number among all points.
struct GroupedPoint {
  std::int32_t q[3];
  std::uint32_t row;
};

/// The place of a cell in the grid; places are ordered as the cells are.
struct GridPlace {
  std::uint32_t z, y, x;
  friend bool operator==(const GridPlace&, const GridPlace&) = default;
  friend bool operator<(const GridPlace& a, const GridPlace& b) {
    return std::tie(a.z, a.y, a.x) < std::tie(b.z, b.y, b.x);
  }
};

/// Points sorted by the cells of a regular grid, which are so small that all points of a cell are
/// neighbours. Only cells with points are kept. Runs in the caller's arena of oneTBB.
class CellGrid {
 public:
  /// The bytes of a point that is alone in its cell.
  static constexpr std::uint64_t kBytesOfPoint =
      sizeof(GroupedPoint) + sizeof(GridPlace) + sizeof(std::uint32_t);

  /// A grid that begins at `origin`, the smallest stored integer of all points on each axis, of the
  /// `count` points for whose number takes(number) is true. points: fewer than 2^32 - 1.
  CellGrid(std::span<const QuantumPoint> points, const Neighbourhood& neighbourhood,
           const QuantumPoint& origin, std::size_t count,
           const std::function<bool(std::size_t)>& takes);

  std::uint32_t cells() const { return static_cast<std::uint32_t>(places_.size()); }
  std::span<const GridPlace> places() const { return places_; }
  std::span<const GroupedPoint> points(std::uint32_t cell) const {
    return {points_.data() + first_[cell], first_[cell + 1] - first_[cell]};
  }

 private:
  std::vector<GroupedPoint> points_;
  std::vector<GridPlace> places_;
  /// The first point of each cell, and at the end the number of all points.
  std::vector<std::uint32_t> first_;
};

/// The layer of a coordinate of a grid that begins at `origin` and has cells with this edge.
inline std::uint64_t layer_of(std::int32_t q, std::int32_t origin, std::uint64_t edge) {
  return static_cast<std::uint64_t>(std::int64_t{q} - origin) / edge;
}

enum class Nearness { kNear, kFar, kOpen };

template <typename Point>
bool are_neighbours(const Neighbourhood& neighbourhood, const Point& a, const Point& b) {
  return neighbourhood.within(difference_of(a.q[0], b.q[0]), difference_of(a.q[1], b.q[1]),
                              difference_of(a.q[2], b.q[2]));
}

/// Whether any of some points has a neighbour among others, found by comparing all pairs.
template <typename Point>
bool any_neighbours(const Neighbourhood& neighbourhood, std::span<const Point> a,
                    std::span<const Point> b) {
  return std::ranges::any_of(a, [&](const Point& p) {
    return std::ranges::any_of(b,
                               [&](const Point& q) { return are_neighbours(neighbourhood, p, q); });
  });
}

/// Whether a point of one cell has a neighbour in the other, in a time proportional to the number
/// of points, which may leave it open: few points are all compared with each other, and of many
/// only those that seem to be nearest.
Nearness compare_cells(const Neighbourhood& neighbourhood, std::span<const GroupedPoint> a,
                       std::span<const GroupedPoint> b);

}  // namespace clearway
