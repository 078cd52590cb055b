#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "clearway/box.hpp"
#include "clearway/conflicts.hpp"
#include "clearway/pose.hpp"
#include "clearway/vec3.hpp"
#include "core/geometry/quantisation.hpp"
#include "core/util/progress.hpp"
#include "findings/colliding_points.hpp"
#include "findings/group/cell_grid.hpp"
#include "findings/group/point_groups.hpp"

namespace clearway {

/// The unit vector to the left in the model's frame.
Vec3 direction_to_left(Axis forward, Axis up);

/// The model's forward axis at a pose; about of unit length, as the pose's rotation is.
Vec3 direction_ahead(const Pose& pose, Axis forward);

/// The vector from the position of a pose to a place, along the model's axes: ahead, to the left,
/// up.
Vec3 ahead_left_up(const Vec3& place, const Pose& pose, Axis forward, Axis up);

/// On which side of the model's box another box lies. seen: the other box, along the axes of
/// ahead_left_up(). The side is left, right, above or below where the whole box lies beyond that
/// side, namely the side that it is farthest beyond. Otherwise the box is in the way: in front or
/// behind where all of it lies ahead or behind. For a box that reaches into the model's, it is the
/// side on which it would be outside soonest. Among equal sides, the first of left, right, above,
/// below, front, behind.
Side side_of(const Box& seen, const Box& model, Axis forward, Axis up);

/// A box of the model's frame, along the axes of ahead_left_up().
Box turned(const Box& box, Axis forward, Axis up);

/// The path cut into stretches at multiples of a length.
class PathStretches {
 public:
  /// split: the length, above 0, or 0 for one single stretch.
  PathStretches(const std::vector<double>& chainage, double split);

  /// The number of the stretch that a pose is in. Stretches that have a pose are numbered
  /// consecutively from 0.
  std::uint32_t operator[](std::uint32_t pose) const { return number_.empty() ? 0 : number_[pose]; }

 private:
  /// The stretch of each pose; empty where there is only one.
  std::vector<std::uint32_t> number_;
};

/// The axes along which a model is seen.
struct AheadLeftUp {
  Axis forward, up;
};

/// The points of a conflict that are touched at its first pose, by the body that touches the first
/// of them.
struct TouchedFirst {
  std::uint32_t first_pose = 0, row = 0;
  std::optional<std::uint32_t> body = {};
  const Pose* pose = nullptr;  ///< pose of the body there; null where it is not known
  Vec3 place{};                ///< place of the row's point
  /// The box around the points, with the axes ahead, to the left and up of the pose.
  Box seen{{kMost, kMost, kMost}, {-kMost, -kMost, -kMost}};

  /// Whether all sides of `seen` are finite; false where the pose cannot be inverted.
  bool is_finite() const {
    for (int k = 0; k < 3; ++k) {
      if (!std::isfinite(seen.lo[k]) || !std::isfinite(seen.hi[k])) return false;
    }
    return true;
  }

 private:
  static constexpr double kMost = std::numeric_limits<double>::infinity();
};

/// Fills in `place` and `seen` of each part. part_of_row: the index of each row's part + 1, 0 for
/// rows of no part. Runs in the caller's arena of oneTBB.
void find_touched_first(const CellGrid& grid, const PointGroups& groups,
                        const CollidingPoints& points, std::span<const std::uint32_t> part_of_row,
                        const Quantisation& quantisation, const AheadLeftUp& axes,
                        std::vector<TouchedFirst>& parts, Progress& progress);

}  // namespace clearway
