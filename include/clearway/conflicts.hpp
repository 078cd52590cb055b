#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "clearway/body.hpp"
#include "clearway/box.hpp"
#include "clearway/model.hpp"
#include "clearway/pose.hpp"
#include "clearway/progress.hpp"
#include "clearway/result.hpp"
#include "clearway/vec3.hpp"

namespace clearway {

/// Where a conflict lies, seen from the model.
enum class Side { kUnknown, kLeft, kRight, kAbove, kBelow, kFront, kBehind };

/// "left", ...; "unknown"
inline const char* name_of(Side side) {
  switch (side) {
    case Side::kUnknown:
      return "unknown";
    case Side::kLeft:
      return "left";
    case Side::kRight:
      return "right";
    case Side::kAbove:
      return "above";
    case Side::kBelow:
      return "below";
    case Side::kFront:
      return "front";
    case Side::kBehind:
      return "behind";
  }
  return "";
}

/// An axis of the model's frame, with its sign.
enum class Axis { kPlusX, kMinusX, kPlusY, kMinusY, kPlusZ, kMinusZ };

struct ConflictOptions {
  /// Metres: points at most this far apart belong to the same conflict.
  double gap = 0.3;
  std::uint64_t min_points = 10;  ///< groups of fewer are counted, not listed
  /// Metres along the path: longer groups are cut at multiples of it; 0: never.
  double split = 25;
  double chainage_start = 0;  ///< metres: the chainage of the first pose; cuts stay where they are
  Axis forward = Axis::kPlusX, up = Axis::kPlusZ;  ///< of the model; not along one line
  /// Of the model's points, for results that do not hold it. Without any, sides are unknown.
  std::optional<Box> model_box = {};
  /// The one model of the search, which outlives the call: for least shifts. Of a vehicle, `bodies`
  /// are. Without either, shifts are not known.
  const Model* model = nullptr;
  std::uint64_t memory_bytes = std::uint64_t{4} << 30;
  int threads = 0;  ///< 0: all cores
  ProgressCallback progress = nullptr;
  StopFlag stop = nullptr;
  /// Of a vehicle's result: its bodies, those of the search, which outlive the call. Each conflict
  /// is seen from its body then. Without them sides are unknown, and places are seen from the path.
  std::span<const Body> bodies = {};
};

/// Colliding points that hang together.
struct Conflict {
  std::uint32_t id = 0;      ///< 1, 2, ... by chainage_from, then source
  std::uint64_t points = 0;  ///< colliding ones
  std::uint64_t source = 0;  ///< the smallest of its points
  Box box{};                 ///< of its points, metres
  Vec3 centroid{};           ///< from exact sums of the stored integers
  /// The least index of a pose that touches one of its points, and the greatest. Between poses, of
  /// a pose that stands for the way to the next. See Conflicts::has_last_poses.
  std::uint32_t first_pose = 0, last_pose = 0;
  /// How far along the path first_pose and last_pose are, metres. With motion between poses,
  /// chainage_to is that of the pose after last_pose.
  double chainage_from = 0, chainage_to = 0;
  /// Station of the obstacle itself, metres: the chainage of the pose that it is seen from, plus
  /// how far ahead of that pose the nearest point lies. It is seen from where it is nearest, or,
  /// without clearances, from its first pose and by the first point that is touched there. None
  /// where the pose's rotation cannot be inverted.
  std::optional<double> obstacle_chainage = {};
  /// How far the vehicle has to be shifted to the left, or to the right, along the Y axis of the
  /// path's poses, so that the points of this conflict are free at all its poses; metres. Other
  /// points may need more. None where 2 m do not free them, or the model was not given.
  std::optional<double> shift_left = {}, shift_right = {};
  std::optional<double> least_distance = {};         ///< metres; where the result has clearances
  std::optional<std::uint32_t> nearest_pose = {};    ///< that has it
  std::optional<std::uint64_t> nearest_source = {};  ///< and the point
  std::optional<double> encroachment = {};           ///< radius - least_distance
  /// Of a model with solids, where the result has clearances: how deep the point that lies deepest
  /// is inside it, metres, 0 for none; and how many of the points are inside at any pose.
  std::optional<double> depth = {};
  std::optional<std::uint64_t> points_inside = {};
  std::optional<Vec3> nearest_point = {};  ///< where it is; not for results before version 3
  /// On which side of the model or body the points lie that it touches at the first pose
  /// (docs/design/findings.md, "Sides").
  Side side = Side::kUnknown;
  /// Where the point that obstacle_chainage belongs to lies, metres from the pose's position: to
  /// the left along the model's own axis, and up. The model's box is not needed. None where the
  /// pose's rotation cannot be inverted. With ConflictOptions::bodies, of the pose that the
  /// conflict's body has there.
  std::optional<double> lateral = {}, height = {};
  std::uint64_t group = 0;  ///< smallest source of the whole group, before it was cut
  /// Of a vehicle's result, as an index of Result::bodies(): the one that has the least distance,
  /// or else the one that touches its smallest source of the first pose.
  std::optional<std::uint32_t> body = {};
};

/// A group of too few points to be listed.
struct SmallGroup {
  std::uint64_t points = 0;
  std::uint64_t source = 0;  ///< the smallest of its points
  Box box{};                 ///< of its points, metres
  std::uint32_t first_pose = 0, last_pose = 0;
  double chainage_from = 0, chainage_to = 0;  ///< as Conflict has them
};

struct Conflicts {
  std::vector<Conflict> listed;  ///< by id
  std::uint64_t colliding_points = 0;
  std::uint64_t groups = 0;                          ///< before cutting, small ones too
  std::uint64_t small_groups = 0, small_points = 0;  ///< not listed
  std::vector<SmallGroup> small;                     ///< those, by chainage_from, then source
  /// Whether the result keeps the last poses of its points. Those of older releases do not: then a
  /// conflict's last pose is the greatest first pose of its points, or the nearest pose if that is
  /// greater, and it may touch them later still.
  bool has_last_poses = false;
  double path_length = 0;  ///< metres
  /// The longest stretch of the path that one group has, before it was cut, metres.
  double longest_group = 0;
  std::uint64_t longest_group_points = 0;
};

/// Groups the colliding points of a result. poses: those of the search. conflict_of: where given,
/// becomes the id of each row of the result, 0 for points of small groups. Throws InputError for
/// poses or bodies of another search, UsageError for a result without first poses; Interrupted when
/// asked to stop.
Conflicts find_conflicts(const Result& result, const std::vector<Pose>& poses,
                         const ConflictOptions& options = {},
                         std::vector<std::uint32_t>* conflict_of = nullptr);

}  // namespace clearway
