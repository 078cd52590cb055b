#pragma once

#include <span>

#include "core/pose.hpp"
#include "core/progress.hpp"
#include "io/file.hpp"

namespace clearway {

/// Writes a pose a line, 16 numbers: its 4 x 4 matrix, row-major, with the digits that
/// read_trajectory reads back to the same doubles. Throws ResourceError and Interrupted.
void write_trajectory(std::span<const Pose> poses, const File& file, Progress& progress);

}  // namespace clearway
