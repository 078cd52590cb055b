#pragma once

#include <array>
#include <vector>

#include "core/geometry/box.hpp"

namespace clearway {

/// A model as seen along one of its axes: a grid across that axis, with the range along the axis
/// that the points of each cell cover.
class ModelView {
 public:
  /// Cells are as wide as `cell`, but there are at most 64 along a side. The model has at least one
  /// point.
  ModelView(const std::vector<Vec3>& model, const Box& box, int axis, double cell);

  /// Whether there are model points before and behind `p` along the axis, both farther away than
  /// `distance`.
  bool encloses(const Vec3& p, double distance) const;

  /// The share of empty cells in the model's outline. The outline consists of the cells with points
  /// and of the empty cells that have such cells in all four directions. 0 where the grid is too
  /// coarse to show it.
  double open_share() const;

 private:
  struct Depth {
    double nearest, farthest;  ///< nearest > farthest where the cell has no point
    bool filled() const { return nearest <= farthest; }
  };
  std::size_t column(int side, double x) const;

  Box box_;
  int axis_;
  std::array<int, 2> across_;
  std::array<std::size_t, 2> count_{};
  std::array<double, 2> per_length_{};
  std::vector<Depth> cells_;
};

}  // namespace clearway
