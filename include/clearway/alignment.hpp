#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "clearway/pose.hpp"
#include "clearway/progress.hpp"
#include "clearway/trajectory.hpp"

namespace clearway {

/// The line of a cross-section about which cant turns the track: the rail that stays at the height
/// of the profile, or the middle between both.
enum class CantLine {
  kFile,  ///< the line that the file names
  kNone,  ///< none: the cant is left out
  kCenter,
  kInsideRail,
  kOutsideRail,
  kLeftRail,
  kRightRail
};

/// The order of the coordinates of a place in LandXML.
enum class AxisOrder { kNorthingEasting, kEastingNorthing };

struct AlignmentOptions {
  /// Names of the alignment and of its profile; each may be empty where the file has one alone
  std::string alignment = {}, profile = {};
  /// Internal stations of the first and the last pose, in the unit of the file. None: as far as
  /// plan and profile reach.
  std::optional<double> station_from = {}, station_to = {};
  double step = 0.1;     ///< metres along the alignment from one pose to the next
  bool reverse = false;  ///< drives against the stations: x and y point the other way
  CantLine cant = CantLine::kFile;
  /// Distance in metres between the middles of the two rails, by which cant becomes an angle. None:
  /// 1.5 m for a gauge of 1.435 or 1.5 m; any other gauge is refused then.
  std::optional<double> rail_distance = {};
  AxisOrder order = AxisOrder::kNorthingEasting;
  /// Greatest distance in metres by which an element may miss the next one, or its own end.
  double max_gap = 0.001;
  /// Height in metres of an alignment that has no profile.
  std::optional<double> height = {};
  /// The coordinate reference system of the environment, as well-known text. A file that names
  /// another one gives the warning "alignment-crs". Empty: nothing is compared.
  std::string environment_crs = {};
};

/// Reads an alignment from a LandXML 1.2 file and returns poses in metres along it, in the order of
/// travel. Their model has x forward, y left and z up, with its origin in the middle of the track
/// on the plane of the tops of the rails. remarks: where given, notes and warnings are appended.
/// labels: where given, gets the internal station of each pose. The formulas are in
/// docs/design/trajectory.md, "Alignments". Throws InputError with file and line for anything that
/// is malformed, not read or does not fit together; UsageError for options that do not apply.
std::vector<Pose> read_alignment(const std::filesystem::path& path,
                                 const AlignmentOptions& options = {},
                                 std::vector<Message>* remarks = nullptr,
                                 PoseLabels* labels = nullptr);

}  // namespace clearway
