#pragma once

#include <algorithm>
#include <cstdint>

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

/// The pose of `body` at a pose of the path; null if it has none there.
inline const Pose* pose_at(const Body& body, std::uint32_t pose) {
  return MovingBody{body.name, body.model, body.poses, body.path_pose}.pose_at(pose);
}

}  // namespace clearway
