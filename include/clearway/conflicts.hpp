#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "clearway/axis.hpp"
#include "clearway/body.hpp"
#include "clearway/box.hpp"
#include "clearway/model.hpp"
#include "clearway/pose.hpp"
#include "clearway/progress.hpp"
#include "clearway/result.hpp"
#include "clearway/vec3.hpp"

namespace clearway {

/// Where a conflict lies, seen from the model. kAround: on both sides of it, as a portal does.
enum class Side { kUnknown, kLeft, kRight, kAbove, kBelow, kFront, kBehind, kAround };

/// The name of a side in lower case, such as "left"; "unknown" for kUnknown.
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
    case Side::kAround:
      return "around";
  }
  return "";
}

/// What a length says that was computed for a conflict.
enum class Bound { kExact, kAtLeast };

/// The name of a bound, "exact" or "at-least".
inline const char* name_of(Bound bound) { return bound == Bound::kExact ? "exact" : "at-least"; }

struct ConflictOptions {
  /// Greatest distance of two neighbouring points of a conflict, in the unit of the environment; 0:
  /// 0.3 m, or more where the colliding points are farther apart (Conflicts::gap).
  double gap = 0;
  /// Smaller groups are counted and not listed; 0: as many as the colliding points have on a square
  /// of 10 cm, at least 1 and at most 10 (Conflicts::min_points).
  std::uint64_t min_points = 0;
  /// Longest stretch of a conflict along the path, in metres: longer groups are cut at multiples of
  /// it. 0: groups are never cut.
  double split = 25;
  double chainage_start = 0;  ///< chainage of the first pose, metres; it does not move the cuts
  /// Axes of the model's frame; must not be parallel. They say how the model is seen and turn
  /// nothing. For a result whose model was turned when it was read, they stay as they are here.
  Axis forward = Axis::kPlusX, up = Axis::kPlusZ;
  /// The one model of the search, from which least shifts are computed; it must outlive the call. A
  /// vehicle has `bodies` instead. Without either, shifts are not known.
  const Model* model = nullptr;
  std::uint64_t memory_bytes = std::uint64_t{4} << 30;
  int threads = 0;  ///< 0: all cores
  ProgressCallback progress = nullptr;
  StopFlag stop = nullptr;
  /// Bodies of the search whose result is a vehicle's; they must outlive the call. With them each
  /// conflict is seen from its body; without them sides are unknown, and places are seen from the
  /// path.
  std::span<const Body> bodies = {};
  /// Station of each pose along its alignment, metres, as PoseLabels has it; or empty. It must
  /// outlive the call.
  std::span<const double> station = {};
};

/// Colliding points that hang together: each has a neighbour within the gap.
struct Conflict {
  std::uint32_t id = 0;  ///< 1, 2, ... in the order of chainage_from, then source
  /// 1 for the worst conflict, 2 for the next, and so on (docs/design/findings.md, "Ranks").
  std::uint32_t rank = 0;
  std::uint64_t points = 0;  ///< number of its points
  /// How many of its points collide. The others, which only an error budget adds, are near.
  std::uint64_t colliding = 0;
  std::uint64_t source = 0;  ///< smallest source index of its points
  Box box{};                 ///< box around its points, metres
  Vec3 centroid{};           ///< mean of its points, metres, from exact sums of the stored integers
  /// The least and the greatest index of a pose that touches one of its points. Between poses, each
  /// index stands for the way from that pose to the next.
  std::uint32_t first_pose = 0, last_pose = 0;
  /// Chainage of first_pose and of last_pose, in metres along the path. With motion between poses,
  /// chainage_to is that of the pose after last_pose.
  double chainage_from = 0, chainage_to = 0;
  /// Station along the alignment of the two poses of chainage_from and chainage_to, metres. None
  /// unless the options have stations.
  std::optional<double> station_from = {}, station_to = {};
  /// Station of the obstacle itself, metres: the chainage of the pose that it is seen from, plus
  /// how far ahead of that pose, in the direction in which the path continues, the nearest point
  /// lies (docs/design/findings.md, "Stations and first touch"). It is seen from the pose where it
  /// is nearest; without clearances, from its first pose, by the first point that is touched there.
  /// None if the pose's rotation cannot be inverted.
  std::optional<double> obstacle_chainage = {};
  /// Least shift of the vehicle to the left, or to the right, along the Y axis of the path's poses,
  /// that frees the points of this conflict at all its poses; metres. It is a lower bound, because
  /// other points may need more. None if 2 m do not free them, if none of the points collides, or
  /// if the model was not given.
  std::optional<double> own_shift_left = {}, own_shift_right = {};
  /// What taken off that side of the body which is touched first is enough to free it from this
  /// conflict, in metres; less may do. None where it would take nothing, or more than half of the
  /// body (docs/design/findings.md, "Sides and trims").
  std::optional<double> trim_left = {}, trim_right = {}, trim_above = {}, trim_below = {};
  std::optional<double> least_distance = {};  ///< least clearance, metres; none without clearances
  std::optional<std::uint32_t> nearest_pose = {};  ///< pose that has least_distance
  /// Source index of the point that has least_distance
  std::optional<std::uint64_t> nearest_source = {};
  std::optional<double> encroachment = {};  ///< radius - least_distance, metres
  /// Whether exactly so much is missing, or at least so much, because a surface and points have no
  /// inside. None without an encroachment.
  std::optional<Bound> encroachment_is = {};
  /// Greatest depth of one of the points inside the model, in metres, 0 if none is inside; and how
  /// many of the points are inside at any pose. None unless the model has solids and the result has
  /// clearances.
  std::optional<double> depth = {};
  std::optional<std::uint64_t> points_inside = {};
  /// Source index of the free point that `depth` is measured to. Set where the result has depths
  /// (QueryParameters::depth) and no exact ones of solids: then `depth` is the greatest of them, an
  /// estimate, and points_inside is not known.
  std::optional<std::uint64_t> depth_source = {};
  /// Position of nearest_source
  std::optional<Vec3> nearest_point = {};
  /// The side of the model, or of the body that is touched first, which the least trim is taken
  /// from; otherwise kAround or first_touch (docs/design/findings.md, "Sides and trims").
  Side side = Side::kUnknown;
  /// The side of the model or body on which the points lie that it touches at the first pose.
  Side first_touch = Side::kUnknown;
  /// Place of the point that obstacle_chainage belongs to, in metres from the pose's position: to
  /// the left along the model's own axis, and up. The model's box is not needed. None if the pose's
  /// rotation cannot be inverted. With ConflictOptions::bodies the pose is that of the conflict's
  /// body.
  std::optional<double> lateral = {}, height = {};
  std::uint64_t group = 0;  ///< smallest source index of the whole group before it was cut
  /// Index in Result::bodies() of the body that has the least distance, or else of the body that
  /// touches the point with the smallest source index of the first pose. None if the result is not
  /// a vehicle's.
  std::optional<std::uint32_t> body = {};
  /// Index of the body that is touched first, which the trims are taken from. None as for body.
  std::optional<std::uint32_t> first_body = {};
  /// Whether the conflict is certain, because ten or more of its points that the error budget says
  /// are certainly too close hang together by the gap of the search; otherwise it is possible. None
  /// without a budget.
  std::optional<bool> certain = {};
  /// The class that most of its points have, of several the smallest; and how many have it. None
  /// unless the scans have classes.
  std::optional<std::uint32_t> main_class = {};
  std::optional<std::uint64_t> main_class_points = {};
};

/// A group of too few points to be listed as a conflict.
struct SmallGroup {
  std::uint64_t points = 0;
  std::uint64_t source = 0;  ///< smallest source index of its points
  Box box{};                 ///< box around its points, metres
  std::uint32_t first_pose = 0, last_pose = 0;
  double chainage_from = 0, chainage_to = 0;  ///< chainages of the two poses, as in Conflict
  std::optional<double> station_from = {}, station_to = {};  ///< as in Conflict
};

/// What a group that spans most of the path probably is, by where it lies. kGround: half of it or
/// more is below the model, or in its lowest 0.5 m, left and right of the middle. kInside: all of
/// it lies within the width and height of the model, left and right of the middle, so that nothing
/// reaches in from outside.
enum class GroupPlace { kOther, kGround, kInside };

/// The name of a place, "other", "ground" or "inside".
inline const char* name_of(GroupPlace place) {
  return place == GroupPlace::kGround   ? "ground"
         : place == GroupPlace::kInside ? "inside"
                                        : "other";
}

struct Conflicts {
  std::vector<Conflict> listed;  ///< in the order of their ids
  double gap = 0;                ///< the gap that was used, in the unit of the environment
  std::uint64_t min_points = 0;  ///< the least number of points that was used
  /// How far apart colliding points are: the lower median of their distances to the nearest one at
  /// another place, in the unit of the environment. None where there are fewer than 10 places.
  std::optional<double> spacing = {};
  bool knows_shifts = false;  ///< whether the model or bodies were given, so that shifts are known
  bool knows_trims = false;   ///< whether the boxes of all bodies are known, and so the trims
  std::uint64_t colliding_points = 0;
  /// Number of points that are grouped too because they may be too close in truth; 0 without an
  /// error budget
  std::uint64_t near_points = 0;
  std::uint64_t groups = 0;  ///< number of groups before cutting, small ones included
  /// Numbers of the groups that are not listed, and of their points
  std::uint64_t small_groups = 0, small_points = 0;
  std::vector<SmallGroup> small;  ///< the groups that are not listed, by chainage_from, then source
  double path_length = 0;         ///< length of the path, metres
  /// Longest stretch of the path that a single group has before it is cut, in metres.
  double longest_group = 0;
  std::uint64_t longest_group_points = 0;
  /// Where the points of that group lie when they are first touched, metres above the lowest point
  /// of the model, or of the body that touches them; and what that says of them. Not known unless
  /// the group spans half of the path or more and the box of each body is known.
  std::optional<double> longest_group_height_from = {}, longest_group_height_to = {};
  GroupPlace longest_group_is = GroupPlace::kOther;
  /// How many of the colliding and near points have each class, as in TableSummary::classes.
  std::map<std::uint8_t, std::uint64_t> classes = {};
};

/// Groups the colliding points of a result into conflicts. poses: the poses of the search.
/// conflict_of: where given, becomes the conflict's id for each row of the result, 0 for points of
/// small groups. conflict_of_near: where given, becomes the same for each row of Result::near().
/// Throws InputError for poses or bodies of another search, UsageError for a result without first
/// poses; Interrupted when asked to stop.
Conflicts find_conflicts(const Result& result, const std::vector<Pose>& poses,
                         const ConflictOptions& options = {},
                         std::vector<std::uint32_t>* conflict_of = nullptr,
                         std::vector<std::uint32_t>* conflict_of_near = nullptr);

/// A result with its conflicts, and the conflict of each row of its tables; 0 for rows of small
/// groups.
struct GroupedResult {
  const Result& result;
  const Conflicts& conflicts;
  std::span<const std::uint32_t> conflict_of;       ///< of each colliding point
  std::span<const std::uint32_t> conflict_of_near;  ///< of each near point
  const std::vector<Pose>& poses;
};

}  // namespace clearway
