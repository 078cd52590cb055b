#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/util/progress.hpp"
#include "report/packed_points.hpp"

namespace clearway {

/// Writes the page: what the browser runs, the facts (JSON) and the columns. Returns the size of
/// the page in bytes. Throws ResourceError.
std::uint64_t write_page(const std::filesystem::path& path, const std::string& title,
                         const std::string& facts, const std::vector<PageColumn>& columns);

}  // namespace clearway
