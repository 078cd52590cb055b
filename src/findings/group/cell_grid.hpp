#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

#include "findings/group/neighbourhood.hpp"

namespace clearway {

/// The stored integers of a point, one on each axis.
struct QuantumPoint {
  std::int32_t q[3];
};

/// A point and the row of the result that it comes from.
struct GridPoint {
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
  static constexpr std::uint64_t kBytesOfPoint = sizeof(GridPoint);
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
  std::span<const GridPoint> points(std::uint32_t cell) const {
    return {points_.data() + first_[cell], first_[cell + 1] - first_[cell]};
  }
  /// The points of a cell, whose order the caller may change.
  std::span<GridPoint> points(std::uint32_t cell) {
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
  std::vector<GridPoint> points_;
  std::vector<GridPlace> places_;
  /// The first point of each cell, and at the end the number of all points.
  std::vector<std::uint32_t> first_;
};

}  // namespace clearway
