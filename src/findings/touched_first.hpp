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
