#pragma once

#include <filesystem>

#include "io/result/conflicts/bcf/bcf.hpp"
#include "io/result/conflicts/conflict_file.hpp"

namespace clearway {

/// Writes conflicts in any format. pictures: used only for BCF. Throws ResourceError, and
/// UsageError for more than BCF holds.
void write_conflicts(const ConflictFile& conflicts, const ConflictPictures& pictures,
                     ConflictFormat format, const std::filesystem::path& path);

}  // namespace clearway
