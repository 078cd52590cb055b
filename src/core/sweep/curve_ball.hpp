#pragma once

#include <cmath>

#include "core/geometry/sweep_bounds.hpp"
#include "core/trajectory/motion_tree_ref.hpp"

namespace clearway {

/// A ball around the curve that a point moves along, seen from the model, while the model moves
/// through the poses of a node (MotionParabola).
struct CurveBall {
  Vec3 centre;  ///< what the middle pose makes of the point
  double radius = 0;

  /// From c(s) to c(t) is (t - s)(way + (1 - s - t) bend). The middle place s lies between 1/3 and
  /// 1/2.
  CLEARWAY_HD CurveBall(const MotionTreeRef& motion, const MotionNode& node, const Vec3& e) {
    const MotionParabola through(node);
    centre = motion.inverse_poses[through.middle].apply(e);
    if (node.count == 1) return;
    const Vec3 first =
        through.middle == through.first ? centre : motion.inverse_poses[through.first].apply(e);
    const Vec3 way = difference(motion.inverse_poses[through.last].apply(e), first);
    const double height = through.height(), t = through.middle_place;
    Vec3 bend{};
    for (int k = 0; k < 3 && height > 0; ++k) {
      bend[k] = (centre[k] - first[k] - t * way[k]) / height;
    }
    const double length = std::sqrt(squared_length(way.x, way.y, way.z));
    const double bent = std::sqrt(squared_length(bend.x, bend.y, bend.z));
    radius = greater_of(t, 1 - t) * (length + bent) * kRoundedUp;
  }
};

}  // namespace clearway
