#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "clearway/progress.hpp"
#include "core/util/progress.hpp"
#include "io/formats/point_reader.hpp"

namespace clearway {

/// The files of a list that can be read, and why the others cannot.
struct ReadableFiles {
  std::vector<std::filesystem::path> files;
  std::vector<std::string> reasons;  ///< why files were left out, with their names
};

/// Reads every file to its end. Throws InputError where none can be read, and Interrupted.
ReadableFiles readable_files(std::span<const std::filesystem::path> files,
                             const PointReadOptions& how_to_read, Progress& progress);

/// The warning on files that were left out; nullopt where there are none.
std::optional<Message> warning_on_skipped(std::span<const std::string> reasons);

}  // namespace clearway
