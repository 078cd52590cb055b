#pragma once

#include <filesystem>
#include <vector>

#include "clearway/search.hpp"

namespace clearway::tool {

/// `others`, and all files that the vehicle's file names, with itself.
std::vector<std::filesystem::path> vehicle_inputs(const std::filesystem::path& file,
                                                  std::vector<std::filesystem::path> others);

/// Throws UsageError, before large inputs are read, for what the library would refuse after that.
void check_vehicle_search(const SearchOptions& options);

}  // namespace clearway::tool
