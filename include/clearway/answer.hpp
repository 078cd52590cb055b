#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "clearway/error_budget.hpp"
#include "clearway/found_place.hpp"
#include "clearway/ignored.hpp"
#include "clearway/progress.hpp"
#include "clearway/query.hpp"
#include "clearway/seen.hpp"
#include "clearway/shard.hpp"
#include "clearway/unsearched.hpp"

namespace clearway {

/// Whether the model passes. kUnknown is the verdict of a single part of a divided query that has
/// no colliding point; merge() gives the verdict of all parts together.
enum class Verdict { kClear, kConflict, kUndecided, kUnknown };

/// Why a verdict is kUndecided, in the order in which reasons are listed.
enum class Reason {
  kNear,  ///< a point is closer than the margin plus the error budget's U_clear
  kFew,   ///< points are certainly too close, but too few of them hang together
  /// Points are near, but the errors are so large that no surface could be a certain conflict
  kErrorsExceedMargin,
  kNotScanned,      ///< the model passes through places that no beam of the scanner reached
  kQuestionInDoubt  ///< a warning puts the question, or a stretch of its path, in doubt: see Doubt
};

const char* name_of(Verdict verdict);  ///< "clear", "conflict", "undecided" or "unknown"
const char* name_of(Reason reason);    ///< "near", "few", "errors-exceed-margin" and so on

/// What a warning says about an answer that found nothing. A doubt means that the search may not
/// have found what stands in the way, so that an empty result is no answer.
enum class Doubt {
  kNone,     ///< the answer stands
  kStretch,  ///< on the stretches of the path that the warning names nothing could be found
  kQuestion  ///< nothing could be found at all, or the scan, model or path was probably misread
};

/// The doubt that a message raises. A note raises none, and neither does a warning about stretches
/// that names none, because it is about the path as a whole.
Doubt doubt_of(const Message& message);

/// Whether doubt_of() is Doubt::kQuestion for a warning with this code, as for "out-of-reach",
/// "no-points", "coarse-digits" or "store-cut-off".
bool is_doubt(std::string_view code);

/// Whether a warning with this code says that points are missing from the scan, so that what stood
/// there in an earlier scan may stand there still. Some of these warnings are no doubts: a road
/// that is open to one side is no reason to distrust a clear way.
bool lacks_points(std::string_view code);

/// What an error budget says of the colliding points.
struct CertainPoints {
  std::uint64_t points = 0;  ///< number of points that are certainly too close
  bool has_group = false;    ///< whether ten or more of them hang together by the query's gap
};

/// The colliding point that is farthest from any free point; among equal ones, the one with the
/// smallest source index.
struct DeepestPoint {
  double depth = 0;  ///< metres, the distance to the nearest free point
  std::uint64_t source = 0;
  Vec3 xyz{};
  std::uint64_t depth_source = 0;  ///< source index of that free point
};

/// What the tables of a result say in short: their numbers of rows and the places that matter most.
struct TableSummary {
  std::uint64_t colliding_points = 0;
  /// Number of points that do not collide but are closer than the margin plus the error budget
  std::uint64_t near_points = 0;
  std::uint64_t clearance_points = 0;  ///< number of points closer than the clearance asked for
  std::uint64_t inside_points = 0;     ///< number of clearance_points inside a solid of the model
  /// Number of poses closer than the profile's distance asked for
  std::uint64_t profile_poses = 0;
  /// The point with the smallest first pose, the one with the least clearance, and the least
  /// distance of the profile at its first pose, each where the query asks for it. Among equal
  /// points, the one with the smallest source index is given.
  std::optional<FoundPlace> first_place, least_clearance, least_profile;
  /// How many of the colliding and near points have each class, ascending by class; empty unless
  /// the scans have classes.
  std::map<std::uint8_t, std::uint64_t> classes;
  /// The colliding point with the greatest depth, where depths were asked for and a point is free.
  std::optional<DeepestPoint> deepest;
};

/// The answer to a query in short. Everything that words or counts an answer takes it from here:
/// search() and merge() report it, and Result::answer() reads it from a file.
struct Answer : TableSummary {
  /// What the query asked for; its lists of ignored classes and boxes are ascending, without
  /// duplicates
  QueryParameters parameters;
  std::uint64_t environment_points = 0, model_points = 0, poses = 0;
  std::uint64_t model_solids = 0;  ///< number of solids of the model, that is parts with an inside
  /// Spacing of a mesh that was searched as points, in metres: no place of its surface is farther
  /// than this from a sample. With several bodies it is the greatest spacing; 0 if no model is a
  /// sampled mesh.
  double model_spacing = 0;
  /// How many points of the whole environment the search left out; its lists are in the order of
  /// those of the parameters.
  IgnoredPointCounts ignored;
  /// How many of the ignored points would collide if they were searched, and how many of these the
  /// model first touches more than half a metre above its lowest point.
  std::uint64_t ignored_colliding = 0, ignored_colliding_high = 0;
  /// How many points would collide without a floor and neither collide nor are near with it. They
  /// are not judged. nullopt without a floor.
  std::optional<std::uint64_t> floor_colliding;
  std::vector<std::string> bodies;  ///< names of the bodies, if the query has several
  /// The floor of each body in metres of its frame, its own or that of the query; empty where no
  /// body has one
  std::vector<std::optional<double>> body_floors;
  std::optional<Shard> shard;  ///< the shard that this answer is about; nullopt for a whole query
  /// Warnings about the question and its inputs, in the order in which they were given. Results
  /// keep them, and those of the machine that searched are not among them.
  std::vector<Message> warnings;
  /// How much of the path the answer is about, because bodies on pivots have no pose at its ends.
  /// nullopt in the result file of one model, whose path was searched to its whole length.
  std::optional<SearchedLength> searched;

  /// The error budget; nullopt if none was given, and the verdict is about the scanned points.
  std::optional<ErrorBudget> budget;
  CertainPoints certain;  ///< what the budget says of the colliding points
  /// What is known of the space that the model sweeps; nullopt if that was not asked for.
  std::optional<SeenSummary> seen;

  /// The verdict. Without an error budget a single colliding point is a conflict, however doubtful
  /// the question is. With one, a group of points that are certainly too close is.
  Verdict verdict() const;
  std::vector<Reason> reasons() const;  ///< why the verdict is kUndecided; empty for other verdicts
  /// The doubt that one of the warnings raises about this answer. Points that are missing from the
  /// scan raise none where beams of the scanner passed through all that the model sweeps.
  Doubt doubt_of(const Message& warning) const;
  /// The codes of the warnings that raise a doubt about this answer, and those of the others, each
  /// once and in alphabetical order.
  std::vector<std::string> doubts() const;
  std::vector<std::string> warned_of() const;
  /// Whether the model passes through places that no beam reached, in groups that are listed.
  bool is_not_scanned() const { return seen && seen->listed_groups > 0; }
  /// Whether a warning puts the question, or a stretch of its path, in doubt.
  bool is_in_doubt() const;
  /// Whether any point is closer than what a clear passage has to keep free.
  bool is_near() const { return colliding_points + near_points > 0; }
  /// The place of the least distance that is known; nullopt if no distance is.
  const std::optional<FoundPlace>& nearest() const;
  /// How many points are inside the model; nullopt without solids or clearances.
  std::optional<std::uint64_t> points_inside() const;
  /// The greatest depth of a point inside the model in metres, 0 if no point is inside; nullopt
  /// without solids, or without distances.
  std::optional<double> greatest_depth() const;
};

}  // namespace clearway
