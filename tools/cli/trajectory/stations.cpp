#include "cli/trajectory/stations.hpp"

#include <spdlog/spdlog.h>

#include <cstddef>

#include "core/trajectory/chainage.hpp"
#include "io/files/file.hpp"
#include "io/paths/trajectory_file.hpp"

namespace clearway::tool {

void tell_of_labels(const std::filesystem::path& input, const PoseLabels& labels) {
  if (labels.time.empty() && labels.name.empty()) return;
  spdlog::info("{}: its times and names are left out, as the output has {}", input.string(),
               labels.station.empty() ? "matrices only" : "matrices and stations only");
}

std::vector<double> stations_along(const std::vector<Pose>& before,
                                   const std::vector<double>& stations,
                                   const std::vector<Pose>& after) {
  if (stations.empty()) return {};
  const std::vector<double> way = chainage_of(after);
  // The poses that both have: where they are along `after`, and their stations.
  std::vector<double> known_at, known;
  std::vector<bool> is_known(after.size());
  for (std::size_t i = 0, k = 0; i < before.size() && k < after.size();) {
    if (before[i] == after[k]) {
      known_at.push_back(way[k]);
      known.push_back(stations[i++]);
      is_known[k++] = true;
    } else if (after.size() > before.size()) {
      ++k;
    } else {
      ++i;
    }
  }
  std::vector<double> out;
  std::size_t met = 0;
  for (std::size_t k = 0; k < after.size(); ++k) {
    out.push_back(is_known[k] ? known[met++] : value_at(known_at, known, way[k]));
  }
  return out;
}

void write_poses(const std::vector<Pose>& poses, const std::vector<double>& stations,
                 const std::filesystem::path& path, Progress& progress) {
  const File file = File::create(path);
  if (stations.empty()) return write_trajectory(poses, file, progress);
  write_trajectory_table(poses, {.stations = stations}, file, progress);
}

}  // namespace clearway::tool
