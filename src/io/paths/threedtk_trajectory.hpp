#pragma once

#include <filesystem>

#include "io/paths/trajectory_file.hpp"

namespace clearway {

/// Reads one .pose or .frames file; options.format says which.
void read_threedtk_file(const std::filesystem::path& path, const TrajectoryOptions& options,
                        TrajectoryFile& out);

/// Reads a folder with scanNNN.frames or scanNNN.pose, one pose per scan, in the order of their
/// numbers. Where both kinds exist, the .frames are used, which hold the final poses of the scans;
/// each scan must then have one. Throws InputError for a folder without any.
void read_threedtk_folder(const std::filesystem::path& folder, const TrajectoryOptions& options,
                          TrajectoryFile& out);

}  // namespace clearway
