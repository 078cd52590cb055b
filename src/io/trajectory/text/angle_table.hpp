#pragma once

#include <string>
#include <vector>

#include "io/trajectory/attitude.hpp"
#include "io/trajectory/text/trajectory_columns.hpp"
#include "io/trajectory/trajectory_file.hpp"

namespace clearway {

/// Appends the poses of a table with roll, pitch and heading or yaw. rows: angles in the units of
/// the file; positions in metres already unless they are geographic. name: the file's, for
/// messages. Throws InputError where unit or frame of the angles are neither declared nor certain,
/// and where the values contradict them.
void append_poses_of_angles(std::vector<AttitudeRow> rows, const PoseColumns& columns,
                            const TrajectoryOptions& options, const std::string& name,
                            TrajectoryFile& out);

}  // namespace clearway
