#pragma once

#include <array>
#include <vector>

#include "core/geometry/box.hpp"

namespace clearway {

/// A model as it is seen along an axis: which cells of a grid across it hold points, and from where
/// to where along the axis.
class ModelView {
 public:
  /// Cells are as wide as `cell`, but not so narrow that there are more than 64 a side.
  /// The model has a point.
  ModelView(const std::vector<Vec3>& model, const Box& box, int axis, double cell);

  /// Whether there are model points before and behind a place, both farther away than `distance`.
  bool encloses(const Vec3& p, double distance) const;

  /// Of the cells with points, and of those empty ones that have such cells to all four sides, the
  /// share of the empty ones; 0 where the grid is too coarse to tell.
  double open_share() const;

 private:
  struct Depth {
    double nearest, farthest;  ///< nearest > farthest: no point
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
