#pragma once

#include <filesystem>

namespace clearway::tool {

/// Throws InputError, saying what the file is and what to do, where it surely is not what the
/// option takes. Everything else is left to the readers.
void check_is_store(const std::filesystem::path& path);
void check_is_model(const std::filesystem::path& path);
void check_is_trajectory(const std::filesystem::path& path);

}  // namespace clearway::tool
