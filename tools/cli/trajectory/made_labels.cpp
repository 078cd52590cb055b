#include "cli/trajectory/made_labels.hpp"

#include <spdlog/spdlog.h>

#include <cstddef>

#include "core/trajectory/chainage.hpp"
#include "io/files/file.hpp"

namespace clearway::tool {

void tell_of_labels(const std::filesystem::path& input, const PoseLabels& labels) {
  bool are_any_left_out = false;
  for_each_label([&](const auto& label) {
    are_any_left_out |= !label.is_interpolated && !label.of(labels).empty();
  });
  if (!are_any_left_out) return;
  const std::string left_out =
      names_of_labels([](const auto& label) { return !label.is_interpolated; });
  const std::string kept = names_of_labels(
      [&](const auto& label) { return label.is_interpolated && !label.of(labels).empty(); });
  spdlog::info("{}: its {} are left out, as the output has matrices {}only", input.string(),
               left_out, kept.empty() ? "" : "and " + kept + " ");
}

namespace {

/// The values of a label of each pose of `after`; see labels_along(). way: along `after`.
std::vector<double> values_along(const std::vector<Pose>& before, const std::vector<double>& values,
                                 const std::vector<Pose>& after, const std::vector<double>& way) {
  // The poses that both have: where they are along `after`, and their values.
  std::vector<double> known_at, known;
  std::vector<bool> is_known(after.size());
  for (std::size_t i = 0, k = 0; i < before.size() && k < after.size();) {
    if (before[i] == after[k]) {
      known_at.push_back(way[k]);
      known.push_back(values[i++]);
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

}  // namespace

PoseLabels labels_along(const std::vector<Pose>& before, const PoseLabels& labels,
                        const std::vector<Pose>& after) {
  const std::vector<double> way = chainage_of(after);
  return made_labels(labels, [&](const std::vector<double>& values) {
    return values_along(before, values, after, way);
  });
}

void write_poses(const std::vector<Pose>& poses, const PoseLabels& labels,
                 const TrajectoryFile& given, const std::filesystem::path& path, Progress& progress,
                 TrajectoryColumns further) {
  const File file = File::create(path);
  further.unit = given.own_unit();
  further.metres_per_unit = given.metres_per_unit;
  further.remarks = given.remarks;
  const bool is_table = has_labels(labels) || further.names_unit() || !further.path_pose.empty();
  if (!is_table) return write_trajectory(poses, file, progress, labels.made_by, given.remarks);
  write_trajectory_table(poses, labels, further, file, progress);
}

}  // namespace clearway::tool
