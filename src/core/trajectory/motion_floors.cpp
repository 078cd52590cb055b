#include "core/trajectory/motion_floors.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/sweep_bounds.hpp"

namespace clearway {
namespace {

MotionFloor floor_of(const MotionTree& motion, const MotionNode& node) {
  const InversePose& middle = motion.inverse_pose(node.mid);
  const auto poses = static_cast<std::uint32_t>(motion.poses().size());
  const std::uint32_t end =
      std::min(poses, node.first + node.count + (motion.between_poses() ? 1 : 0));
  double squared_tilt = 0, rise = 0;
  for (std::uint32_t i = node.first; i < end; ++i) {
    const InversePose& pose = motion.inverse_pose(i);
    double squared = 0, height = 0;
    for (int k = 0; k < 3; ++k) {
      const double turned = pose.inverse[6 + k] - middle.inverse[6 + k];
      squared += turned * turned;
      height += pose.inverse[6 + k] * (middle.translation[k] - pose.translation[k]);
    }
    squared_tilt = std::max(squared_tilt, squared);
    rise = std::max(rise, std::abs(height));
  }
  return {std::sqrt(squared_tilt) * kRoundedUp, rise * kRoundedUp};
}

}  // namespace

MotionFloors::MotionFloors(const MotionTree& motion, int threads) : floors_(motion.nodes().size()) {
#pragma omp parallel for schedule(dynamic, 64) num_threads(threads)
  for (std::size_t i = 0; i < floors_.size(); ++i) {
    floors_[i] = floor_of(motion, motion.nodes()[i]);
  }
}

}  // namespace clearway
