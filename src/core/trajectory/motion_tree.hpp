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
  /// model: a box around every model point; it and the poses must be finite. between_poses: a
  /// pose's range includes the motion on to the next pose.
  MotionTree(std::span<const Pose> poses, const Box& model, bool between_poses = false,
             int threads = 1);

  std::span<const MotionNode> nodes() const { return nodes_; }
  std::span<const Pose> poses() const { return poses_; }
  const InversePose& inverse_pose(std::uint32_t pose) const { return inverse_poses_[pose]; }

  /// Pulls e back: returns x with transform(pose, x) = e, up to a rounding of at most rounding()
  /// metres times `greatest`.
  Vec3 pulled_back(std::uint32_t pose, const Vec3& e) const {
    return inverse_poses_[pose].apply(e);
  }

  /// The tree for look-ups. Valid while the tree and the poses live.
  MotionTreeRef ref() const {
    return {nodes_.data(), inverse_poses_.data(), poses_.data(),
            static_cast<std::uint32_t>(poses_.size())};
  }

  /// Bound in metres of all roundings of a test at a node, predicate and pull-back. reach: greatest
  /// coordinate of environment points; lattice: how far, in metres of the model's frame, the
  /// lattice of the look-ups extends beyond the model (docs/design/numerics.md).
  double rounding(double reach, double lattice = 0) const;

  /// Bound in metres on how far the height of an environment point in the body's frame, computed
  /// with any inverse_pose(), is from the exact test's (core/geometry/floor.hpp). reach: as for
  /// rounding().
  double height_rounding(double reach) const;
  bool between_poses() const { return between_poses_; }

  std::uint64_t allocated_bytes() const;

 private:
  void add(std::uint32_t first, std::uint32_t count);
  void find_deltas(const Box& model, int threads);
  double delta_of(std::uint32_t node, const Box& model) const;
  double delta_below(std::uint32_t node, std::uint32_t mid, int levels, const Box& model) const;

  std::span<const Pose> poses_;
  bool between_poses_;
  std::vector<double> travelled_;  ///< motion up to each pose, metres; only while building
  std::vector<MotionNode> nodes_;
  std::vector<InversePose> inverse_poses_;
  double condition_ = 1;  ///< greatest condition of all rotations
  double greatest_ = 1;   ///< upper bound on 1 and of every pose's stretch
  double magnitude_ = 0;  ///< bound on translations plus moved model points
};

}  // namespace clearway
