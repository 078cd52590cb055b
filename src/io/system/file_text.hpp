#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace clearway {

/// The whole contents of a small file. Throws ResourceError.
std::string text_of_file(const std::filesystem::path& path);

/// Writes the file under another name and renames it, so that readers see either the old or the new
/// contents. It is not synced: after a crash of the system the file may be empty. Throws
/// ResourceError.
void replace_file(const std::filesystem::path& path, std::string_view text);

}  // namespace clearway
