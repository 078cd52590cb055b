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
  kMatrix,          ///< a row-major 3x4 or 4x4 matrix: 12 or 16 numbers a line
  kTum,             ///< t x y z qx qy qz qw
  kEuroc,           ///< CSV: ns, position, quaternion w x y z
  kCsv,             ///< a header names the columns
  kPoseXyzw,        ///< x y z qx qy qz qw
  kPoseWxyz,        ///< x y z qw qx qy qz
  kSbet,            ///< Applanix, 17 doubles a record
  kThreedtkPose,    ///< a .pose file, or a folder of them
  kThreedtkFrames,  ///< a .frames file, whose last line is used, or a folder of them
};

/// The unit of angles that the file itself does not declare.
enum class AngleUnit { kDeclared, kDegrees, kRadians };

/// What roll, pitch and the third angle mean; see docs/design/trajectory.md, "Frames and angles".
enum class AngleFrame {
  kDeclared,  ///< a column "heading" means kNed, a column "yaw" is refused
  kNed,       ///< clockwise from north, nose up, right side down: navigation
  kEnu,       ///< counter-clockwise from east, nose down, right side down: robotics
};

struct TrajectoryOptions {
  TrajectoryFormat format = TrajectoryFormat::kAuto;
  /// Accepts matrices that are not rigid, but still no singular or non-finite ones
  bool allow_non_rigid = false;

  AngleUnit angle_unit = AngleUnit::kDeclared;
  AngleFrame angle_frame = AngleFrame::kDeclared;
  /// The projected coordinate reference system that latitudes and longitudes are converted to:
  /// anything that PROJ understands, for example "EPSG:25832". A trailing "+ellipsoidal" says that
  /// the heights of the environment are ellipsoidal.
  std::string crs = {};
  /// Coordinate reference system for when `crs` is empty, as well-known text, for example the
  /// environment's.
  std::string default_crs = {};
  /// The geographic coordinate reference system of latitudes and longitudes; empty: WGS 84.
  std::string datum = {};
  /// The unit of positions, for example kMetresPerMillimetre or FileUnit::named("us-ft"). None: the
  /// unit that the file declares, or else the unit of the environment.
  FileUnit metres_per_unit = {};
  /// Length of the environment's unit in metres, as Store::metres_per_unit() returns it. Positions
  /// in a known unit are converted to it.
  double environment_unit = 1;
  /// Whether environment_unit is only assumed because the environment names no unit. A file in
  /// another unit then gives the warning "unit-assumed".
  bool environment_unit_is_assumed = false;
  /// Position, in the model's frame and the environment's unit, of the point whose track the file
  /// holds.
  Vec3 lever_arm{0, 0, 0};
};

/// What a file says of its poses apart from where they are. Each list has one entry for each pose,
/// or is empty.
struct PoseLabels {
  std::vector<double> time = {};       ///< seconds, in the time scale of the file
  std::vector<std::string> name = {};  ///< a name for the reader, or the file's own index
  std::vector<double> station = {};    ///< metres along an alignment, which are not the way driven
  /// How `clearway trajectory` made the file of another one, whose name and number of poses it
  /// says; empty for other files.
  std::string made_by = {};
};

/// Reads the poses of a trajectory in one of the formats of TrajectoryFormat. They belong to a
/// model whose frame is that of the file; for roll, pitch and heading, SBET and 3DTK that model has
/// x forward, y left and z up. Rotations stay as read (matrices) or follow from the normalised
/// quaternion or the angles. An empty trajectory gives an empty vector. remarks: where given, notes
/// on how the file was understood and warnings are appended. labels: where given, becomes what the
/// file says of its poses. Throws InputError with file and line or byte for anything malformed or
/// ambiguous and, unless allowed, for a matrix whose singular values are not within 1e-4 of 1;
/// UsageError for options that do not apply to the file.
std::vector<Pose> read_trajectory(const std::filesystem::path& path,
                                  const TrajectoryOptions& options = {},
                                  std::vector<Message>* remarks = nullptr,
                                  PoseLabels* labels = nullptr);

}  // namespace clearway
