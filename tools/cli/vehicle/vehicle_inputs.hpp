#pragma once

#include <filesystem>
#include <vector>

#include "clearway/search.hpp"

namespace clearway::tool {

/// Whether a file is that of a vehicle and not a model, which never begins as JSON does.
bool names_vehicle(const std::filesystem::path& file);

/// `others`, the vehicle's file, and all files that it names.
std::vector<std::filesystem::path> vehicle_inputs(const std::filesystem::path& file,
                                                  std::vector<std::filesystem::path> others);

/// Throws UsageError for options that the library would refuse only after it has read large inputs.
void check_vehicle_search(const SearchOptions& options);

}  // namespace clearway::tool
