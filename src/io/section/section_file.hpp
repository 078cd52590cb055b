#pragma once

#include <filesystem>

#include "clearway/section.hpp"

namespace clearway {

/// Writes a section to a new file (docs/design/section.md, "The file"). Throws ResourceError.
void write_section(const SectionData& section, const std::filesystem::path& path);

/// Reads a section and checks all of it. Throws InputError where it is not an intact, complete
/// section of this version, ResourceError where it cannot be read.
SectionData read_section(const std::filesystem::path& path);

}  // namespace clearway
