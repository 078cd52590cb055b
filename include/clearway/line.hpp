#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "clearway/alignment.hpp"
#include "clearway/file_unit.hpp"
#include "clearway/pose.hpp"
#include "clearway/progress.hpp"
#include "clearway/trajectory.hpp"

namespace clearway {

class Store;

struct LineOptions {
  double step = 0.1;     ///< metres along the line in plan from one pose to the next
  bool reverse = false;  ///< drives from the last vertex to the first: x and y point the other way
  /// Height in metres of a line whose vertices have none. On the ground: about where the ground is
  /// looked for at the first vertex; without it, it may be at any height there.
  std::optional<double> height = {};
  /// Radius in metres of arcs that touch both legs at every vertex where the line turns; the legs
  /// then are straight. None: a smooth curve leads through the vertices, and a vertex that turns by
  /// more than kMostLineTurn is refused.
  std::optional<double> corner_radius = {};
  /// A store whose ground under both wheel tracks gives height and roll; it must outlive the call.
  /// Its unit counts as that of the environment. The rule is in docs/design/trajectory.md, "On the
  /// ground". Under a parked car the ground is not seen, and the path is about 0.3 m too high.
  const Store* ground = nullptr;
  /// Distance in metres between the middles of the left and the right wheels; only on the ground.
  std::optional<double> track = {};
  /// What a column of cant turns the track about, which is the line of the file; kNone leaves the
  /// cant out. A line names none itself, so kFile is kCenter.
  CantLine cant = CantLine::kCenter;
  /// Distance in metres between the middles of the two rails, by which cant becomes an angle. None:
  /// 1.5 m, which is that of standard gauge, with a note.
  std::optional<double> rail_distance = {};
  /// The unit of the coordinates. None: the unit that the file declares, or else that of the
  /// environment.
  FileUnit unit = {};
  /// Length of the environment's unit in metres, as Store::metres_per_unit() returns it.
  double environment_unit = 1;
  /// Whether environment_unit is only assumed because the environment names no unit. A file in
  /// another unit than the metre then gives the warning "unit-assumed".
  bool environment_unit_is_assumed = false;
  /// The coordinate reference system of the environment, as well-known text. A file that names
  /// another one gives the warning "line-crs". Empty: nothing is compared.
  std::string environment_crs = {};
};

/// The angle in degrees by which a line may turn at a vertex that is not rounded.
inline constexpr double kMostLineTurn = 15;

/// Reads a line and returns poses in metres along it, in the order of travel, for a model with x
/// forward, y left and z up. The file is a table with the columns x, y and, where it has them, z,
/// station and cant, which its first line names; or GeoJSON with exactly one LineString, whose
/// coordinates are those of the environment and not longitude and latitude. remarks: where given,
/// notes and warnings are appended. labels: where given, gets the station of each pose, in metres,
/// if the file has stations. The formulas are in docs/design/trajectory.md, "Lines". Throws
/// InputError with file and line or key for anything that is malformed, not read or does not fit
/// together; UsageError for options that do not apply.
std::vector<Pose> read_line(const std::filesystem::path& path, const LineOptions& options = {},
                            std::vector<Message>* remarks = nullptr, PoseLabels* labels = nullptr);

}  // namespace clearway
