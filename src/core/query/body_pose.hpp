#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "clearway/body.hpp"
#include "clearway/pose.hpp"

namespace clearway {

/// The pose of a body at a pose of the path; null if it has none there. path_pose: as in Body; if
/// empty, the poses are those of the path.
inline const Pose* pose_at(std::span<const Pose> poses, std::span<const std::uint32_t> path_pose,
                           std::uint32_t pose) {
  if (path_pose.empty()) return pose < poses.size() ? &poses[pose] : nullptr;
  const auto at = std::ranges::lower_bound(path_pose, pose);
  if (at == path_pose.end() || *at != pose) return nullptr;
  return &poses[static_cast<std::size_t>(at - path_pose.begin())];
}

/// The pose of `body` at a pose of the path; null if it has none there.
inline const Pose* pose_at(const Body& body, std::uint32_t pose) {
  return body.poses.empty() ? nullptr : pose_at(body.poses, body.path_pose, pose);
}

}  // namespace clearway
