#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "clearway/follow.hpp"
#include "clearway/pose.hpp"
#include "clearway/progress.hpp"
#include "clearway/vec3.hpp"
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

  /// Poses of a towed body that lie in the first three lengths from its hitch to its axle, where
  /// the straight line in which it begins still matters
  std::vector<std::uint64_t> transient;
  /// The greatest angle in plan by which the tower of a towed body turns away from its first
  /// heading meanwhile, radians
  double transient_turn = 0;
  /// Poses in or before whose next way the hitch of a towed body goes back a little
  std::vector<std::uint64_t> rolled_back;
  /// The pose from whose next way on the hitch of a towed body goes back too far, so that its poses
  /// end there
  std::optional<std::uint64_t> pushed_from = std::nullopt;
};

/// A moment while the path is travelled: a place of the path, and its station in metres.
struct PathMoment {
  PathStations::Place place;
  double station;
};

/// How a pose of a body came about; the states of one pose are or-ed.
enum BodyState : std::uint8_t { kOffPath = 1, kUndefined = 2, kFolded = 4, kTurned = 8 };

/// The pose of a body at a moment; none where the state has kOffPath or kUndefined.
struct BodyPose {
  Pose pose{};
  std::uint8_t state = 0;

  bool exists() const { return (state & (kOffPath | kUndefined)) == 0; }
};

/// The pose of a body at a station or on pivots while the vehicle is at a moment of the path.
BodyPose body_pose_at(const PathStations& path, const PathMoment& moment, const BodyMount& mount);

/// The pose of a body whose x axis is `x`, of length 1: z is `mean_up` made perpendicular to it.
/// There is none where both are parallel.
BodyPose framed(const Vec3& x, const Vec3& mean_up, const Vec3& origin);

/// The poses that a body at a station or on pivots has on the path. Throws InputError for pivots on
/// a path that mirrors the model. docs/design/bodies.md.
FollowedPath follow_path(const PathStations& path, const BodyMount& mount, int threads);

/// Throws InputError if the path mirrors the model, because a body on pivots or behind a hitch is
/// placed by a rotation.
void refuse_mirroring(const PathStations& path);

/// Adds the pose of a body at pose `index` of the path, or the reason why it has none.
void add_pose(FollowedPath& followed, std::uint64_t index, const BodyPose& body);

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
