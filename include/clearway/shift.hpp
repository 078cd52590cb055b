#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "clearway/axis.hpp"
#include "clearway/conflicts.hpp"
#include "clearway/progress.hpp"
#include "clearway/query.hpp"
#include "clearway/result.hpp"
#include "clearway/session.hpp"

/// What must move to pass: the least shifts to one side that free a path, and each place of it that
/// does not fit.
namespace clearway {

/// Which shifts are tried. Lengths are in the environment's unit.
struct ShiftOptions {
  /// The shifts are the multiples of `step` between these two, which are part of the range. Shifts
  /// to the left are above 0, and 0 must be in the range.
  double lateral_from = -2, lateral_to = 2;
  double step = 0.01;
  /// Axes of the path's poses that point ahead and up, as in ConflictOptions. A shift goes along
  /// the axis to their left, which is +Y by default.
  Axis forward = Axis::kPlusX, up = Axis::kPlusZ;
  double chainage_start = 0;  ///< chainage of the first pose, metres
  /// Station of each pose along its alignment, metres, as PoseLabels has it; or empty. It must
  /// outlive the call.
  std::span<const double> station = {};
  ProgressCallback progress = nullptr;
  StopFlag stop = nullptr;
};

/// The most shifts that may be tried.
inline constexpr std::uint64_t kMostShifts = 1'000'000;

/// The least shift that frees a stretch of the path.
struct StretchShift {
  std::uint32_t conflict = 0;  ///< Conflict::id, whose stretch it is; 0 for the whole path
  /// The poses of the stretch, both included. Between poses, the way from each of them to the next
  /// belongs to it too.
  std::uint32_t first_pose = 0, last_pose = 0;
  double chainage_from = 0, chainage_to = 0;                 ///< metres, as in Conflict
  std::optional<double> station_from = {}, station_to = {};  ///< as in Conflict
  /// The shift with the least length, metres, above 0 to the left; of two equally long ones the one
  /// to the left. None if no shift of the range frees the stretch.
  std::optional<double> shift = {};
  /// The least distance on the shifted stretch, metres. None without a shift, if nothing is closer
  /// than the clearance that the result was asked for, or if that is not above the radius.
  std::optional<double> least_distance = {};
  std::uint64_t searches = 0;  ///< searches that were needed to find the shift
  /// Codes of warnings, ascending. With a shift, those that a run along the shifted stretch causes
  /// and one along the stretch as it is does not, such as "nothing-below", because the shift leads
  /// past what was scanned. Without one, those that put in doubt every shift at which nothing
  /// collides, so that it frees nothing: see Doubt.
  std::vector<std::string> warned_of = {};
};

/// The shifts of a path and of its conflicts.
struct ShiftTable {
  double lateral_from = 0, lateral_to = 0, step = 0;  ///< the shifts that were tried, metres
  StretchShift path;                                  ///< of the whole path
  std::vector<StretchShift> conflicts;                ///< one for each conflict, in their order
  std::uint64_t searches = 0;                         ///< searches that were needed for all of them
  double seconds = 0;                                 ///< wall-clock seconds that they took
};

/// Finds the least lateral shift of the whole path of a result, and that of the stretch of each
/// conflict, from its first to its last touch, that frees it. A shift by l moves every body at pose
/// i by l times the left axis of the path's pose i. It frees a stretch if no point of the
/// environment collides at any pose of the shifted stretch, or with an error budget, if none is
/// closer than what a clear passage has to keep free, and if no warning puts that in doubt. Every
/// shift that is returned was confirmed by a search of the whole environment without the points
/// that the result ignored (docs/design/findings.md, "Shifts that free a stretch").
///
/// session: of the store that was searched; it answers for several conflicts at once. query: what
/// moves, and the poses, as they were for the result; its parameters are not used, because the
/// result has them. conflicts: those of find_conflicts() for the result. Throws InputError if
/// store, model, bodies or poses are not those of the result; UsageError for options that make no
/// sense and for a result that is not exact; ResourceError; Interrupted when asked to stop.
ShiftTable find_shifts(const Session& session, const Result& result, const Query& query,
                       std::span<const Conflict> conflicts, const ShiftOptions& options = {});

}  // namespace clearway
