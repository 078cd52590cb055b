#pragma once

#include "io/paths/trajectory_file.hpp"
#include "io/scans/input_buffer.hpp"

namespace clearway {

/// Reads a trajectory in lines of text: matrices, quaternions, or a table with a header. Lines that
/// start with # or // are comments. Throws InputError and UsageError.
void read_text_trajectory(InputBuffer input, const TrajectoryOptions& options, TrajectoryFile& out);

}  // namespace clearway
