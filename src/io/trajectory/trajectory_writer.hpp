#pragma once

#include <span>

#include "clearway/pose.hpp"
#include "core/util/progress.hpp"
#include "io/system/file.hpp"

namespace clearway {

/// Writes one pose per line as 16 numbers: its 4 x 4 matrix, row-major, with digits that
/// read_trajectory() reads back to the same doubles. Throws ResourceError and Interrupted.
void write_trajectory(std::span<const Pose> poses, const File& file, Progress& progress);

}  // namespace clearway
