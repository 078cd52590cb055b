#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "clearway/follow.hpp"
#include "clearway/pose.hpp"
#include "clearway/progress.hpp"
#include "core/trajectory/follow/path_stations.hpp"

namespace clearway {

/// The poses of a body that follows a path. Indices count the path's poses and ascend.
struct FollowedPath {
  std::vector<Pose> poses;        ///< those there are
  std::vector<std::uint64_t> of;  ///< the path's pose of each

  std::vector<std::uint64_t> off_path;   ///< no pose: a station is off the path
  std::vector<std::uint64_t> undefined;  ///< no pose: the chord has no direction, or points up
  std::vector<std::uint64_t> folded;     ///< the chord is shorter than half of the way between
  std::vector<std::uint64_t> turned;     ///< the path's axes are not about the body's
};

/// Throws InputError for pivots on a path that mirrors the model. docs/design/bodies.md.
FollowedPath follow_path(const PathStations& path, const BodyMount& mount, int threads);

/// Warnings of what is missing or odd in it; a note where stations are off the path at its ends
/// only, and on no more than half of it. name: whose poses these are, for the texts.
std::vector<Message> doubts_about(const FollowedPath& followed, const PathStations& path,
                                  const BodyMount& mount, const std::string& name);

}  // namespace clearway
