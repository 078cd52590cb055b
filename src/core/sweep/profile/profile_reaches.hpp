#pragma once

#include <cmath>
#include <cstdint>

#include "core/geometry/sweep_bounds.hpp"
#include "core/sweep/profile/sweep_profile.hpp"
#include "core/trajectory/motion_tree_ref.hpp"

namespace clearway {

/// Distances beyond which nothing matters any more to poses and motion nodes of a profile.
struct ProfileReaches {
  const MotionTreeRef& motion;
  const ProfileBests& bests;
  double rounding;

  /// A distance for a squared distance: a pose at which no model point is nearer than this has only
  /// d2 above `squared`.
  CLEARWAY_HD double of(double squared) const { return std::sqrt(squared) * kRoundedUp + rounding; }

  CLEARWAY_HD double of_node(std::uint32_t index) const {
    const MotionNode& node = motion.nodes[index];
    return node.count == 1 ? of(greater_of(load_shared(bests.of_pose + node.mid), 0))
                           : load_shared(bests.of_node + index);
  }

  /// Lowers the reach of a motion node. To be called by one lane.
  CLEARWAY_HD void note(std::uint32_t index, double reach) const {
    if (reach < load_shared(bests.of_node + index)) store_shared(bests.of_node + index, reach);
  }

  /// Lowers the reach of a node to the larger reach of its halves. To be called by one lane.
  CLEARWAY_HD void note_halves(std::uint32_t index) const {
    note(index, greater_of(of_node(index + 1), of_node(motion.nodes[index].later)));
  }
};

}  // namespace clearway
