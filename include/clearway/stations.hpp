#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "clearway/answer.hpp"
#include "clearway/body.hpp"
#include "clearway/box.hpp"
#include "clearway/conflicts.hpp"
#include "clearway/found_place.hpp"
#include "clearway/pose.hpp"
#include "clearway/progress.hpp"
#include "clearway/result.hpp"

namespace clearway {

struct StationOptions {
  /// Length of a stretch, metres along the path. Stretches begin at the first pose, and the last
  /// one may be shorter.
  double every = 5;
  double chainage_start =
      0;  ///< chainage of the first pose, metres; it does not move the stretches
  /// Axes of the model's frame; must not be parallel
  Axis forward = Axis::kPlusX, up = Axis::kPlusZ;
  /// Bodies of the search whose result is a vehicle's; they must outlive the call. Without them
  /// neither sides nor overthrow are known, and no stretch of such a result is clear unless all
  /// bodies were searched on the whole path.
  std::span<const Body> bodies = {};
  /// Station of each pose along its alignment, metres, as PoseLabels has it; or empty. It must
  /// outlive the call.
  std::span<const double> station = {};
  int threads = 0;  ///< 0: all cores
  ProgressCallback progress = nullptr;
  StopFlag stop = nullptr;
};

/// By how much the centre line of a rigid body leaves the path in a curve, metres: the greatest
/// values on a stretch (docs/design/findings.md, "Overthrow"). None where the body has no pose
/// there, or where the path does not reach below its ends or its middle.
struct Overthrow {
  std::optional<double> end = {};     ///< outwards, of the body's two ends
  std::optional<double> middle = {};  ///< inwards, of the body's middle
};

/// A stretch of the path.
struct StationRow {
  double chainage_from = 0, chainage_to = 0;  ///< metres
  /// Station along the alignment at chainage_from and chainage_to, metres, interpolated linearly
  /// along the way between the stations of the poses. None without stations.
  std::optional<double> station_from = {}, station_to = {};
  /// The nearest point of the stretch: the least of the profile of its poses, and of the clearances
  /// of the points whose nearest pose is on it. Of equally near points, the one with the smallest
  /// source index. None where there is no such point, and where least_below says more.
  std::optional<FoundPlace> least = {};
  /// The radius, on a stretch with a conflict whose least distance is not known: it is below this.
  std::optional<double> least_below = {};
  /// The distance that the profile was asked for, on a clear stretch where it found nothing: the
  /// least distance is at least this at every pose.
  std::optional<double> least_above = {};
  /// The point that has the least clearance of all whose nearest pose is on the stretch and that
  /// lie there to the left of their body's box; to the right of it; above it.
  std::optional<FoundPlace> left = {}, right = {}, above = {};
  /// What is known of the stretch: kClear, kConflict or kUndecided.
  Verdict verdict = Verdict::kClear;
  /// Why the verdict is kUndecided, except because the vehicle was not searched; see is_searched.
  std::vector<Reason> reasons = {};
  /// Codes of the warnings for which kQuestionInDoubt is one of the reasons, in alphabetical order:
  /// those that put the whole question in doubt, and those that name poses of this stretch.
  std::vector<std::string> doubts = {};
  /// Whether the whole vehicle was searched on all of the stretch. If not, it is never kClear.
  bool is_searched = true;
  std::vector<Overthrow> overthrow = {};  ///< one for each of StationTable::bodies
};

/// What a client asks of a path, stretch by stretch.
struct StationTable {
  /// Names of the bodies; for one model a single empty name.
  std::vector<std::string> bodies;
  std::vector<StationRow> rows;  ///< in the order of the path; none if it has no poses
  std::vector<Message> warnings;
};

/// The most stretches that a table may have.
inline constexpr std::size_t kMostStationRows = 100'000;

/// Describes the path of a result, stretch by stretch. poses: the poses of the search. Throws
/// InputError for poses or bodies of another search, and as reading the tables does; UsageError for
/// a result without first poses, for a length of stretches that is not above 0 or makes more than
/// kMostStationRows, and for stations that are not one for each pose; Interrupted when asked to
/// stop.
StationTable station_table(const Result& result, const std::vector<Pose>& poses,
                           const StationOptions& options = {});

}  // namespace clearway
