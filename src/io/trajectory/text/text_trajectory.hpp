#pragma once

#include "io/formats/input_buffer.hpp"
#include "io/trajectory/trajectory_file.hpp"

namespace clearway {

/// Reads a trajectory in lines of text: matrices, quaternions, or a table with a header. Lines that
/// start with # or // are comments. Throws InputError and UsageError.
void read_text_trajectory(InputBuffer input, const TrajectoryOptions& options, TrajectoryFile& out);

}  // namespace clearway
