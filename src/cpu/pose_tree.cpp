#include "cpu/pose_tree.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/rigid.hpp"

namespace clearway {

PoseTree::PoseTree(std::span<const Pose> poses, std::uint32_t first, std::uint32_t count,
                   const Box& model, bool between_poses) {
  nodes_.reserve(std::size_t{2} * count);
  add(poses, first, count, model, between_poses);
}

std::uint32_t PoseTree::add(std::span<const Pose> poses, std::uint32_t first, std::uint32_t count,
                            const Box& model, bool between_poses) {
  const std::uint32_t reference = first + count / 2;
  double motion = 0;
  const bool moves_on = between_poses && first + count < poses.size();
  for (std::uint32_t i = first; i < first + count + (moves_on ? 1 : 0); ++i) {
    if (i != reference) {
      motion = std::max(motion, displacement_bound(model, poses[reference], poses[i]));
    }
  }
  // Each coordinate of either of two points moved by the reference pose errs by at most `rounding`.
  const double rounding =
      2 * std::sqrt(3.0) * 1.01 * transform_rounding(reach_of(model), poses[reference]);
  const auto self = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back(
      {first, count, reference, 0, 0, motion + rounding, greatest_stretch_bound(poses[reference])});
  if (count > 1) {
    const std::uint32_t earlier = add(poses, first, count / 2, model, between_poses);
    const std::uint32_t later =
        add(poses, first + count / 2, count - count / 2, model, between_poses);
    nodes_[self].earlier = earlier;
    nodes_[self].later = later;
  }
  return self;
}

}  // namespace clearway
