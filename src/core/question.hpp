#pragma once

#include <span>

#include "core/pose.hpp"
#include "core/vec3.hpp"

namespace clearway {

/// What is asked of an environment: which of its points does the model come closer to than `radius`
/// at any pose. Does not own model and poses.
struct Question {
  std::span<const Vec3> model;  ///< in the model's own frame, metres
  std::span<const Pose> poses;
  double radius = 0;           ///< metres, > 0
  bool first_pose = false;     ///< also the smallest pose index that touches each colliding point
  bool between_poses = false;  ///< model points move on straight segments from pose to pose
  double clearance = 0;        ///< metres: distances below it are asked for too; 0: none
  /// Metres: a point whose distance differs from the radius by no more may be answered wrongly; 0:
  /// none. Below the radius, and only without first poses, clearances and motion between poses.
  double tolerance = 0;
};

}  // namespace clearway
