#pragma once

#include <span>
#include <string>

#include "io/trajectory/attitude.hpp"
#include "io/trajectory/trajectory_file.hpp"

namespace clearway {

/// Appends the poses of rows whose positions are longitude and latitude in degrees and an
/// ellipsoidal height in metres, in the CRS of the options; angles are counted from true north or
/// east. name: of the file, for messages. Throws InputError and UsageError.
void append_geographic_poses(std::span<const AttitudeRow> rows, AngleFrame frame,
                             const TrajectoryOptions& options, const std::string& name,
                             TrajectoryFile& out);

}  // namespace clearway
