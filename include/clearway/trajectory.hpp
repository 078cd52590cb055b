#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "clearway/file_unit.hpp"
#include "clearway/pose.hpp"
#include "clearway/progress.hpp"
#include "clearway/vec3.hpp"

namespace clearway {

enum class TrajectoryFormat {
  kAuto,
  kMatrix,          ///< 12 or 16 numbers a line: a row-major 3x4 or 4x4
  kTum,             ///< t x y z qx qy qz qw
  kEuroc,           ///< CSV: ns, position, quaternion w x y z
  kCsv,             ///< a header names the columns
  kPoseXyzw,        ///< x y z qx qy qz qw
  kPoseWxyz,        ///< x y z qw qx qy qz
  kSbet,            ///< Applanix, 17 doubles a record
  kThreedtkPose,    ///< a .pose file, or a folder of them
  kThreedtkFrames,  ///< a .frames file, of which the last line counts, or a folder of them
};

/// Unit of angles that a file does not declare itself.
enum class AngleUnit { kDeclared, kDegrees, kRadians };

/// What roll, pitch and a third angle turn, docs/design/trajectory.md, "Frames and angles".
enum class AngleFrame {
  kDeclared,  ///< a column "heading" means kNed, a column "yaw" is refused
  kNed,       ///< clockwise from north, nose up, right side down: navigation
  kEnu,       ///< counter-clockwise from east, nose down, right side down: robotics
};

struct TrajectoryOptions {
  TrajectoryFormat format = TrajectoryFormat::kAuto;
  bool allow_non_rigid = false;  ///< still refuses singular and non-finite matrices

  AngleUnit angle_unit = AngleUnit::kDeclared;
  AngleFrame angle_frame = AngleFrame::kDeclared;
  /// The projected coordinate reference system that latitudes and longitudes are turned into:
  /// anything that PROJ understands, for example "EPSG:25832". With "+ellipsoidal" behind it the
  /// heights of the environment are said to be ellipsoidal.
  std::string crs = {};
  /// Taken where `crs` is empty: well-known text, for example the environment's.
  std::string default_crs = {};
  /// The geographic CRS of latitudes and longitudes; empty: WGS 84.
  std::string datum = {};
  /// The unit of positions, for example kMetresPerMillimetre or FileUnit::named("us-ft"); none:
  /// metres, unless the file declares another.
  FileUnit metres_per_unit = {};
  /// Metres of the environment's unit, as Store::metres_per_unit() has them, into which a known
  /// unit is converted.
  double environment_unit = 1;
  /// The environment names no unit, and environment_unit is assumed: a file in another unit is then
  /// warned of ("unit-assumed").
  bool environment_unit_is_assumed = false;
  /// Where the point whose positions the file holds lies in the model's frame, in the
  /// environment's unit.
  Vec3 lever_arm{0, 0, 0};
};

/// What a file says of its poses beside where they are. Each list has one entry a pose, or none.
struct PoseLabels {
  std::vector<double> time;       ///< seconds, as the file counts them
  std::vector<std::string> name;  ///< for people: a name, or an index of the file's own
};

/// Reads a trajectory, in the formats above; the poses of a model whose frame is that of the file.
/// For roll, pitch and heading, SBET and 3DTK the model has x forward, y left and z up.
/// Rotations stay as read (matrices) or follow from the normalised quaternion or the angles. Throws
/// InputError with file and line or byte for anything malformed or ambiguous and, unless allowed,
/// for a matrix whose singular values are not within 1e-4 of 1. UsageError for options that do not
/// apply to the file. An empty trajectory gives an empty vector.
/// remarks: where given, notes on how the file was understood and warnings are appended. labels:
/// where given, becomes what the file says of its poses.
std::vector<Pose> read_trajectory(const std::filesystem::path& path,
                                  const TrajectoryOptions& options = {},
                                  std::vector<Message>* remarks = nullptr,
                                  PoseLabels* labels = nullptr);

}  // namespace clearway
