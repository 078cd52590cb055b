#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "clearway/body.hpp"
#include "clearway/pose.hpp"
#include "clearway/query.hpp"

namespace clearway {

/// Encodes a pose of the path and a body in one number, pose * bodies + body. The smallest number
/// of a point is its first pose, and there the lowest body. Hits, clearances, pages and journals
/// hold such numbers in place of poses. With one body or none, a number is the pose itself.
class BodyNumbers {
 public:
  explicit BodyNumbers(std::uint64_t bodies)
      : bodies_(static_cast<std::uint32_t>(std::max<std::uint64_t>(bodies, 1))) {}
  explicit BodyNumbers(const Query& query) : BodyNumbers(query.bodies.size()) {}

  std::uint32_t number(std::uint32_t pose, std::uint32_t body) const {
    return pose * bodies_ + body;
  }
  std::uint32_t pose_of(std::uint32_t number) const {
    return bodies_ == 1 ? number : number / bodies_;
  }
  std::uint32_t body_of(std::uint32_t number) const { return bodies_ == 1 ? 0 : number % bodies_; }
  /// Bound that all numbers are below.
  std::uint64_t end(std::uint64_t poses) const { return poses * bodies_; }

 private:
  std::uint32_t bodies_;
};

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
