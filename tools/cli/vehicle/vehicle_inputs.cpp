#include "cli/vehicle/vehicle_inputs.hpp"

#include <fstream>
#include <string>
#include <system_error>
#include <utility>

#include "clearway/error.hpp"
#include "io/models/vehicle_file.hpp"

namespace clearway::tool {

bool names_vehicle(const std::filesystem::path& file) {
  std::error_code unknown;
  if (!std::filesystem::is_regular_file(file, unknown)) return false;
  char first = 0;
  return std::ifstream(file) >> first && first == '{';
}

std::vector<std::filesystem::path> vehicle_inputs(const std::filesystem::path& file,
                                                  std::vector<std::filesystem::path> others) {
  others.push_back(file);
  for (const BodyEntry& body : read_vehicle_file(file, 1)) {
    for (std::filesystem::path& one : body.files()) others.push_back(std::move(one));
  }
  return others;
}

void check_vehicle_search(const SearchOptions& options) {
  if (options.engine == Engine::kGrid || options.engine == Engine::kKdtree) {
    throw UsageError(std::string("--vehicle: engine ") + clearway::name_of(options.engine) +
                         " searches one model, not a vehicle of several bodies",
                     Remedy::kSweepEngine);
  }
}

}  // namespace clearway::tool
