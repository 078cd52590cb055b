#pragma once

#include <array>
#include <cstdint>

#include "core/geometry/quantisation.hpp"

namespace clearway {

/// Which differences of stored integers are at most the gap (docs/design/findings.md, 4). It is
/// decided in integers where the scales of the three axes are equal, otherwise in double precision.
class Neighbourhood {
 public:
  /// gap: above 0, in the unit of the scale.
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
  /// The least difference of points in cells that are `cells` apart.
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

}  // namespace clearway
