#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "clearway/pose.hpp"
#include "clearway/trajectory.hpp"
#include "core/trajectory/trajectory_doubts.hpp"
#include "core/util/progress.hpp"
#include "io/files/file.hpp"
#include "io/paths/remarks.hpp"

namespace clearway {

/// The contents of a trajectory's file and how they were interpreted.
struct TrajectoryFile : Remarks {
  std::vector<Pose> poses;
  PoseLabels labels;
  TrajectoryFormat format = TrajectoryFormat::kAuto;
  std::string crs;  ///< CRS into which latitudes and longitudes were converted, or empty
  /// Metres per unit of the positions; 1 except for a CRS in another unit.
  double metres_per_unit = 1;
  /// Whether the positions certainly are in metres, because a unit was declared or the format has
  /// one.
  bool in_metres = false;
  FileUnit unit = {};  ///< unit of the positions in the file, where a header or an option names it
  RotationSource rotations = RotationSource::kMatrices;

  /// The unit that the file, its format or its CRS gives the positions; not known where they are in
  /// the environment's unit because nothing names one.
  FileUnit own_unit() const;
};

/// Reads a trajectory as read_trajectory() does, with details of the file.
TrajectoryFile read_trajectory_file(const std::filesystem::path& path,
                                    const TrajectoryOptions& options);

/// The command line's name of a format: "matrix", "tum", ...
const char* name_of(TrajectoryFormat format);

/// What a table of poses has beside x, y, z, r00 to r22 and their labels.
struct TrajectoryColumns {
  /// Index of the path's pose, for each pose; no column where it is empty.
  std::span<const std::uint32_t> path_pose = {};
  /// The unit in which x, y and z are written and which the header names. They are written as they
  /// are, without a unit, where it is not known.
  FileUnit unit = {};
  double metres_per_unit = 1;  ///< metres per unit of the positions that are to be written
  /// Messages of reading what the path was made of; those that put it in doubt are kept in
  /// comments. They must outlive the call.
  std::span<const Message> remarks = {};

  bool names_unit() const;
};

/// Writes a table of poses with a header, and with digits that read_trajectory() reads back to the
/// same doubles. labels: a column for each list that is not empty. Comments have made_by and
/// the remarks.
/// Throws ResourceError and Interrupted.
void write_trajectory_table(std::span<const Pose> poses, const PoseLabels& labels,
                            const TrajectoryColumns& columns, const File& file, Progress& progress);

/// Start of the comment in which a trajectory says how `clearway trajectory` made it of another
/// one.
inline constexpr std::string_view kMadeByComment = "# made by clearway trajectory ";

/// Start of the comments in which a trajectory keeps the warnings that put in doubt what it was
/// made of, because its own form may not show the fault any more. They are read as its own
/// warnings.
inline constexpr std::string_view kDoubtComment = "# in doubt: ";

/// Writes one pose per line as 16 numbers: its 4 x 4 matrix, row-major, with digits that
/// read_trajectory() reads back to the same doubles. made_by: see PoseLabels; empty for none.
/// remarks: as in TrajectoryColumns.
/// Throws ResourceError and Interrupted.
void write_trajectory(std::span<const Pose> poses, const File& file, Progress& progress,
                      const std::string& made_by = {}, std::span<const Message> remarks = {});

}  // namespace clearway
