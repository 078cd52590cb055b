#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

#include "core/geometry/quantisation.hpp"

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
    const double x = static_cast<double>(dx) * step_[0];
    const double y = static_cast<double>(dy) * step_[1];
    const double z = static_cast<double>(dz) * step_[2];
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

  /// The scale of an axis, in the unit of the gap; for guesses only.
  double step(int axis) const { return step_[static_cast<std::size_t>(axis)]; }

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
  std::array<double, 3> step_{};
  double squared_gap_ = 0;
  std::array<std::uint64_t, 3> cell_{};
  std::array<std::uint32_t, 3> cells_away_{};
};

/// The stored integers of a point, one on each axis.
struct QuantumPoint {
  std::int32_t q[3];
};

/// A point and the row of the result that it comes from.
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
  static constexpr std::uint64_t kBytesOfPoint = sizeof(GroupedPoint);
  static constexpr std::uint64_t kBytesOfCell = sizeof(GridPlace) + sizeof(std::uint32_t);

  /// points: fewer than 2^32 - 1, by row. check_cells(count) is called before memory is taken for
  /// that many cells.
  template <typename CheckCells>
  CellGrid(std::span<const QuantumPoint> points, const Neighbourhood& neighbourhood,
           CheckCells check_cells) {
    sort(points, neighbourhood);
    check_cells(count_cells());
    make_cells(points);
  }

  std::uint32_t cells() const { return static_cast<std::uint32_t>(places_.size()); }
  const GridPlace& place(std::uint32_t cell) const { return places_[cell]; }
  std::span<const GridPlace> places() const { return places_; }
  std::span<const GroupedPoint> points(std::uint32_t cell) const {
    return {points_.data() + first_[cell], first_[cell + 1] - first_[cell]};
  }
  /// The points of a cell, whose order the caller may change.
  std::span<GroupedPoint> points(std::uint32_t cell) {
    return {points_.data() + first_[cell], first_[cell + 1] - first_[cell]};
  }
  /// The smallest stored integer of all points on each axis, where the cell (0, 0, 0) begins.
  const QuantumPoint& origin() const { return origin_; }

 private:
  void sort(std::span<const QuantumPoint> points, const Neighbourhood& neighbourhood);
  std::uint64_t count_cells() const;
  void make_cells(std::span<const QuantumPoint> points);

  QuantumPoint origin_{};
  /// Until make_cells(), q holds the place of the point's cell: z, y, x.
  std::vector<GroupedPoint> points_;
  std::vector<GridPlace> places_;
  /// The first point of each cell, and at the end the number of all points.
  std::vector<std::uint32_t> first_;
};

enum class Nearness { kNear, kFar, kOpen };

/// The absolute difference of two stored integers.
inline std::uint64_t difference_of(const std::int32_t a, const std::int32_t b) {
  return static_cast<std::uint64_t>(a < b ? std::int64_t{b} - a : std::int64_t{a} - b);
}

inline bool are_neighbours(const Neighbourhood& neighbourhood, const GroupedPoint& a,
                           const GroupedPoint& b) {
  return neighbourhood.within(difference_of(a.q[0], b.q[0]), difference_of(a.q[1], b.q[1]),
                              difference_of(a.q[2], b.q[2]));
}

/// Whether a point of one cell has a neighbour in the other, found by comparing all pairs.
bool any_neighbours(const Neighbourhood& neighbourhood, std::span<const GroupedPoint> a,
                    std::span<const GroupedPoint> b);

/// Whether a point of one cell has a neighbour in the other, in a time proportional to the number
/// of points, which may leave it open: few points are all compared with each other, and of many
/// only those that seem to be nearest.
Nearness compare_cells(const Neighbourhood& neighbourhood, std::span<const GroupedPoint> a,
                       std::span<const GroupedPoint> b);

}  // namespace clearway
