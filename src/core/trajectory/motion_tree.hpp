#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/box.hpp"
#include "core/trajectory/motion_tree_ref.hpp"

namespace clearway {

/// A binary tree over a trajectory, split where half of the motion is done, so that a jump or a
/// long stop costs nothing. Prior art: the inverted trajectory of NC milling simulation (Sullivan
/// et al. 2012), conservative advancement (Mirtich).
class MotionTree {
 public:
  /// `model` holds every model point; both must be finite. between_poses: a pose's range includes
  /// the motion on to the next pose.
  MotionTree(std::span<const Pose> poses, const Box& model, bool between_poses = false,
             int threads = 1);

  std::span<const MotionNode> nodes() const { return nodes_; }
  std::span<const Pose> poses() const { return poses_; }
  const InversePose& inverse_pose(std::uint32_t pose) const { return inverse_poses_[pose]; }

  /// x with transform(pose, x) = e, up to a rounding of at most rounding() metres times `greatest`.
  Vec3 pulled_back(std::uint32_t pose, const Vec3& e) const {
    return inverse_poses_[pose].apply(e);
  }

  /// Valid while the tree and the poses live.
  MotionTreeRef ref() const {
    return {nodes_.data(), inverse_poses_.data(), poses_.data(),
            static_cast<std::uint32_t>(poses_.size())};
  }

  /// What all roundings of a test at a node, predicate and pull-back, amount to at the most in
  /// metres, for environment points with coordinates of at most `reach`, looked up in a lattice
  /// that goes `lattice` metres of the model's frame beyond the model (docs/design/numerics.md).
  double rounding(double reach, double lattice = 0) const;

  std::uint64_t allocated_bytes() const;

 private:
  void add(std::uint32_t first, std::uint32_t count);
  void find_deltas(const Box& model, int threads);
  double delta_of(std::uint32_t node, const Box& model) const;
  double delta_below(std::uint32_t node, std::uint32_t mid, int levels, const Box& model) const;

  std::span<const Pose> poses_;
  bool between_poses_;
  std::vector<double> travelled_;  ///< up to each pose, metres; only while building
  std::vector<MotionNode> nodes_;
  std::vector<InversePose> inverse_poses_;
  double condition_ = 1;  ///< greatest of all poses
  double greatest_ = 1;   ///< at least 1 and every pose's greatest stretch
  double magnitude_ = 0;  ///< of translations and moved model points
};

}  // namespace clearway
