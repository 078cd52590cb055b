#pragma once

#include <filesystem>
#include <vector>

#include "clearway/body.hpp"
#include "clearway/model.hpp"
#include "clearway/search.hpp"
#include "clearway/trajectory.hpp"

namespace clearway::tool {

/// The bodies of a vehicle's file, placed at the poses of a path. model, trajectory: how their
/// files are read. warnings: those of the files, and of bodies that have no pose at some poses of
/// the path, are appended. Throws InputError naming the key, UsageError where bodies move between
/// poses and have gaps.
std::vector<Body> read_vehicle(const std::filesystem::path& file, const std::vector<Pose>& path,
                               const ModelOptions& model, const TrajectoryOptions& trajectory,
                               int threads, std::vector<Message>& warnings);

/// `others`, and all files that the vehicle's file names, with itself.
std::vector<std::filesystem::path> vehicle_inputs(const std::filesystem::path& file,
                                                  std::vector<std::filesystem::path> others);

/// Throws UsageError, before large inputs are read, for what the library would refuse after that.
void check_vehicle_search(const SearchOptions& options);

}  // namespace clearway::tool
