#pragma once

#include <filesystem>
#include <vector>

#include "clearway/pose.hpp"

namespace clearway::tool {

/// Each function throws InputError, saying what the file is and what to do, where the file surely
/// is not what the option takes. Every other file is left to the readers.
void check_is_store(const std::filesystem::path& path);
void check_is_model(const std::filesystem::path& path);
void check_is_trajectory(const std::filesystem::path& path);

/// Throws InputError for a path without poses, about which nothing can be asked.
void check_has_poses(const std::vector<Pose>& poses, const std::filesystem::path& path);

}  // namespace clearway::tool
