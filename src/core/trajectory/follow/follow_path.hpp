#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "clearway/follow.hpp"
#include "clearway/pose.hpp"
#include "clearway/progress.hpp"
#include "core/trajectory/follow/path_stations.hpp"

namespace clearway {

/// The poses of a body that follows a path. Indices are those of the path's poses, ascending.
struct FollowedPath {
  std::vector<Pose> poses;        ///< the poses that the body has
  std::vector<std::uint64_t> of;  ///< for each of `poses`, the index of the path's pose

  /// Poses without a body's pose, because a station is off the path
  std::vector<std::uint64_t> off_path;
  /// Poses without a body's pose, because the chord has no direction or points up
  std::vector<std::uint64_t> undefined;
  /// Poses whose chord is shorter than half of the way between its pivots
  std::vector<std::uint64_t> folded;
  std::vector<std::uint64_t> turned;  ///< poses at which the path's axes are far from the body's
};

/// The poses that a body has on the path. Throws InputError for pivots on a path that mirrors the
/// model. docs/design/bodies.md.
FollowedPath follow_path(const PathStations& path, const BodyMount& mount, int threads);

/// Warnings of what is missing or odd in a followed path; only a note if stations are off the path
/// just at its ends, and on no more than half of it. name: the body's name for the messages.
std::vector<Message> doubts_about(const FollowedPath& followed, const PathStations& path,
                                  const BodyMount& mount, const std::string& name);

/// The message "body-off-path" about the poses of the path that a body lacks, ascending and at
/// least one: a note if these are the path's ends and at most half of it, else a warning. name: the
/// body's, for the text. why, and what can be done: the rest of the sentence, such as "as a pivot
/// is off the path", and a sentence without its full stop.
Message off_path_message(const std::string& name, const std::vector<std::uint64_t>& missing,
                         std::size_t path_poses, const std::string& why, const std::string& remedy);

}  // namespace clearway
