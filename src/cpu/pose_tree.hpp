#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "clearway/pose.hpp"
#include "core/geometry/box.hpp"

namespace clearway {

/// A range of consecutive poses around a reference pose. At any pose of the range (between poses:
/// also on the way to the next pose) a model point within distance d of a model point c lies within
/// stretch * d + spread of transform(reference pose, c), rounding included
/// (docs/design/numerics.md, "Motion").
struct PoseNode {
  std::uint32_t first;
  std::uint32_t count;
  std::uint32_t reference;
  std::uint32_t earlier, later;  ///< indices of the two halves; only if count > 1
  double spread;                 ///< metres
  double stretch;
};

/// A binary tree over one run of poses.
class PoseTree {
 public:
  static constexpr std::uint32_t kMostPoses = 32;

  /// Builds the tree over poses first .. first + count - 1 of `poses`, 0 < count <= kMostPoses.
  /// model: holds every model point. between_poses: a pose's range includes the motion on to the
  /// next pose.
  PoseTree(std::span<const Pose> poses, std::uint32_t first, std::uint32_t count, const Box& model,
           bool between_poses = false);

  /// Node `index`; node 0 is the root.
  const PoseNode& node(std::uint32_t index) const { return nodes_[index]; }

 private:
  std::uint32_t add(std::span<const Pose> poses, std::uint32_t first, std::uint32_t count,
                    const Box& model, bool between_poses);

  std::vector<PoseNode> nodes_;
};

}  // namespace clearway
