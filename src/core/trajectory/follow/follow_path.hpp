#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "clearway/pose.hpp"
#include "clearway/progress.hpp"
#include "core/trajectory/follow/path_stations.hpp"

namespace clearway {

/// A body that has the path's own pose so many metres ahead of each pose; negative: behind.
struct BodyStation {
  double at = 0;
};

/// A body that lies on the path with two places, so many metres ahead of each pose. Its x axis
/// points from the rear one to the front one; its origin divides the chord as 0 divides the two.
struct BodyPivots {
  double front = 0, rear = 0;  ///< not equal
};

using BodyMount = std::variant<BodyStation, BodyPivots>;

/// The poses of a body that follows a path. Indices count the path's poses and ascend.
struct FollowedPath {
  std::vector<Pose> poses;        ///< those there are
  std::vector<std::uint64_t> of;  ///< the path's pose of each

  std::vector<std::uint64_t> off_path;   ///< no pose: a station is off the path
  std::vector<std::uint64_t> undefined;  ///< no pose: the chord has no direction, or points up
  std::vector<std::uint64_t> folded;     ///< the chord is shorter than half of the way between
  std::vector<std::uint64_t> turned;     ///< the body's x axis is not along the path's
};

/// Throws InputError for pivots on a path that mirrors the model. docs/design/bodies.md.
FollowedPath follow_path(const PathStations& path, const BodyMount& mount, int threads);

/// Warnings of what is missing or odd in it. name: whose poses these are, for the texts.
std::vector<Message> doubts_about(const FollowedPath& followed, const PathStations& path,
                                  const BodyMount& mount, const std::string& name);

}  // namespace clearway
