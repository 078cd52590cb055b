#include "core/trajectory/thin_trajectory.hpp"

#include "core/trajectory/trajectory_motion.hpp"

namespace clearway {

std::vector<std::size_t> thin_trajectory(std::span<const Pose> poses, const Box& model,
                                         double max_motion) {
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const bool stood_for =
        !kept.empty() && motion_bound(model, poses[kept.back()], poses[i]) <= max_motion;
    if (!stood_for) kept.push_back(i);
  }
  return kept;
}

}  // namespace clearway
