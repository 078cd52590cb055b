#pragma once

#include <filesystem>
#include <vector>

#include "clearway/body.hpp"
#include "clearway/model.hpp"
#include "clearway/trajectory.hpp"

namespace clearway::tool {

/// The bodies of a vehicle's file, placed at the poses of a path. model, trajectory: how their
/// files are read. warnings: those of the files, and of bodies that have no pose at some poses of
/// the path, are appended. Throws InputError naming the key, UsageError where bodies move between
/// poses and have gaps.
std::vector<Body> read_vehicle(const std::filesystem::path& file, const std::vector<Pose>& path,
                               const ModelOptions& model, const TrajectoryOptions& trajectory,
                               int threads, std::vector<Message>& warnings);

}  // namespace clearway::tool
