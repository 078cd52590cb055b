#pragma once

#include <filesystem>
#include <type_traits>
#include <vector>

#include "clearway/pose.hpp"
#include "clearway/trajectory.hpp"
#include "core/describe/labels.hpp"
#include "core/util/progress.hpp"
#include "io/paths/trajectory_file.hpp"

namespace clearway::tool {

/// Says which labels of a trajectory the output does not keep.
void tell_of_labels(const std::filesystem::path& input, const PoseLabels& labels);

/// The labels of a trajectory that is made of a given one: make(values) of each label that such a
/// trajectory keeps and the given one has.
template <typename Make>
PoseLabels made_labels(const PoseLabels& given, const Make& make) {
  PoseLabels out;
  for_each_label([&](const auto& label) {
    if constexpr (!std::decay_t<decltype(label)>::is_text()) {
      const std::vector<double>& values = label.of(given);
      if (label.is_interpolated && !values.empty()) label.of(out) = make(values);
    }
  });
  return out;
}

/// The labels of a changed trajectory. The poses of one of the two are all among those of the
/// other, in the same order. Those of `after` that `before` lacks get values between those of their
/// neighbours, linear in the way along `after`.
PoseLabels labels_along(const std::vector<Pose>& before, const PoseLabels& labels,
                        const std::vector<Pose>& after);

/// Writes poses that are made of a given trajectory: a table where there are labels, a unit or
/// further columns to name, and matrices otherwise. Their unit is that of the given file, so that
/// the new one is understood as that was. further: what else the table has.
void write_poses(const std::vector<Pose>& poses, const PoseLabels& labels,
                 const TrajectoryFile& given, const std::filesystem::path& path, Progress& progress,
                 TrajectoryColumns further = {});

}  // namespace clearway::tool
