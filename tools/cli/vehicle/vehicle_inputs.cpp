#include "cli/vehicle/vehicle_inputs.hpp"

#include <string>

#include "clearway/error.hpp"
#include "io/models/vehicle_file.hpp"

namespace clearway::tool {

std::vector<std::filesystem::path> vehicle_inputs(const std::filesystem::path& file,
                                                  std::vector<std::filesystem::path> others) {
  others.push_back(file);
  for (const BodyEntry& body : read_vehicle_file(file, 1)) {
    others.push_back(body.model);
    if (!body.trajectory.empty()) others.push_back(body.trajectory);
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
