#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "clearway/pose.hpp"
#include "clearway/trajectory.hpp"
#include "core/trajectory/alignment/alignment.hpp"
#include "io/paths/remarks.hpp"

/// What alignments and lines share when poses are made along them.
namespace clearway {

/// Poses that were made along an alignment or a line, and remarks on its file.
struct PosesAlong : Remarks {
  std::vector<Pose> poses;       ///< in the order of travel, metres
  std::vector<double> stations;  ///< of each pose, metres; empty where the file has none

  /// Moves the poses out, the remarks behind those of `messages`, and the stations into `labels`;
  /// both may be null.
  std::vector<Pose> hand_over(std::vector<Message>* messages, PoseLabels* labels);
};

/// A stretch of an alignment or a line: its stations in metres.
struct Reach {
  double from = 0, to = 0;
};

/// Stations, as lengths, count as equal up to this many metres.
inline constexpr double kSameStation = 1e-6;

/// The greatest number of poses that are made along one alignment or line.
inline constexpr double kMostPosesAlong = 1e7;

/// Throws UsageError where an option has a value that is not finite or not `good`.
void check_option(const std::optional<double>& value, const char* option, bool good,
                  const char* expected);

/// The stations from + i step below `to`, and `to` itself, in metres. Throws UsageError for more
/// than kMostPosesAlong.
std::vector<double> even_stations(double from, double to, double step);

/// Turns poses round for travel in the other direction: their order, and their axes x and y.
/// stations: of the poses, or empty.
void turn_round(std::vector<Pose>& poses, std::vector<double>& stations);

/// Warns of a cant that is in another unit or to the wrong side: "cant-unit", "cant-side". poses:
/// made along the track with this cant.
void remark_cant(const std::string& name, const AlignmentCant& cant, double rail_distance,
                 std::span<const Pose> poses, Remarks& out);

/// The EPSG code of the environment where it is another system than that of `code`; nullopt where
/// they agree or one of them is not known. code: 0 where it is not known. environment: well-known
/// text, or empty.
std::optional<std::int32_t> other_epsg(long code, const std::string& environment);

/// The warning that coordinates of a file are in another system than the environment. what: the
/// file's content, for the advice to transform it.
std::string other_crs_text(const std::string& name, long code, std::int32_t environment,
                           const std::string& what);

}  // namespace clearway
