#pragma once

#include <filesystem>

#include "io/conflicts/bcf/bcf.hpp"
#include "io/conflicts/conflict_file.hpp"

namespace clearway {

/// Writes them. pictures: for BCF. Throws ResourceError; UsageError for more than BCF holds.
void write_conflicts(const ConflictFile& conflicts, const ConflictPictures& pictures,
                     ConflictFormat format, const std::filesystem::path& path);

}  // namespace clearway
