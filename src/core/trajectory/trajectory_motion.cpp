#include "core/trajectory/trajectory_motion.hpp"

#include <algorithm>

#include "core/geometry/rigid.hpp"

namespace clearway {

double motion_bound(const Box& model, const Pose& a, const Pose& b) {
  return a == b ? 0 : displacement_bound(model, a, b);
}

double largest_motion(const Box& model, std::span<const Pose> poses) {
  double largest = 0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    largest = std::max(largest, motion_bound(model, poses[i - 1], poses[i]));
  }
  return largest;
}

}  // namespace clearway
