#pragma once

#include <span>
#include <string>

#include "io/paths/pose_input.hpp"
#include "io/paths/trajectory_file.hpp"

namespace clearway {

/// Appends the poses of rows whose positions are longitude and latitude in degrees and an
/// ellipsoidal height in metres, converted into the CRS of the options. Angles are counted from
/// true north or east. name: the file's, for messages. Throws InputError and UsageError.
void append_geographic_poses(std::span<const AttitudeRow> rows, AngleFrame frame,
                             const TrajectoryOptions& options, const std::string& name,
                             TrajectoryFile& out);

}  // namespace clearway
