#pragma once

#include <filesystem>
#include <optional>
#include <span>

#include "clearway/progress.hpp"
#include "io/convert/checks/file_boxes.hpp"
#include "io/store/store_metadata.hpp"

namespace clearway {

/// The warning on inputs whose bytes equal those of an earlier one: the same file named twice, or a
/// copy of it. Inputs without points do not count. sources: descriptions of the files as read.
std::optional<Message> warning_on_same_scans(std::span<const std::filesystem::path> files,
                                             std::span<const SourceFile> sources,
                                             std::span<const FileBox> boxes);

}  // namespace clearway
