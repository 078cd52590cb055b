#pragma once

#include <filesystem>

#include "io/trajectory/trajectory_file.hpp"

namespace clearway {

/// Reads one .pose or .frames file, as options.format says.
void read_threedtk_file(const std::filesystem::path& path, const TrajectoryOptions& options,
                        TrajectoryFile& out);

/// Reads a folder with scanNNN.frames or scanNNN.pose: a pose a scan, by their numbers. Where both
/// are there, the .frames count, which hold where the scans came to lie; each scan must have one
/// then. Throws InputError for a folder without any.
void read_threedtk_folder(const std::filesystem::path& folder, const TrajectoryOptions& options,
                          TrajectoryFile& out);

}  // namespace clearway
