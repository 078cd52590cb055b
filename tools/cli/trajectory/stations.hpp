#pragma once

#include <filesystem>
#include <vector>

#include "clearway/pose.hpp"
#include "clearway/trajectory.hpp"
#include "core/util/progress.hpp"

namespace clearway::tool {

/// Says which labels of a trajectory the output does not keep.
void tell_of_labels(const std::filesystem::path& input, const PoseLabels& labels);

/// The station of each pose of a changed trajectory; empty where the given one has none. The poses
/// of one of the two are all among those of the other, in the same order. Those of `after` that
/// `before` lacks get stations between those of their neighbours, linear in the way along `after`.
std::vector<double> stations_along(const std::vector<Pose>& before,
                                   const std::vector<double>& stations,
                                   const std::vector<Pose>& after);

/// Writes poses: matrices, or with stations a table that has them too.
void write_poses(const std::vector<Pose>& poses, const std::vector<double>& stations,
                 const std::filesystem::path& path, Progress& progress);

}  // namespace clearway::tool
