#pragma once

#include <filesystem>
#include <vector>

#include "clearway/body.hpp"
#include "clearway/model.hpp"
#include "clearway/pose.hpp"
#include "clearway/progress.hpp"
#include "clearway/trajectory.hpp"

namespace clearway {

struct VehicleOptions {
  /// How the models of all bodies are read; a body's own model_unit overrides the unit. Lengths of
  /// the vehicle's file that have a unit are converted to environment_unit. Stations and pivots are
  /// along the turned x axis.
  ModelOptions model = {};
  /// How the trajectories of bodies that have one of their own are read
  TrajectoryOptions trajectory = {};
  int threads = 0;  ///< 0: all cores; the bodies do not depend on the number
};

/// Reads the JSON file of a vehicle (docs/guide/vehicles.md) and the files that it names. Returns
/// its bodies in the file's order, with the poses that they have while the vehicle follows `path`;
/// they are what Query::bodies takes, and `path` is Query::poses. warnings: where given, notes and
/// warnings about the files, and about what is missing or odd at poses, are appended. Throws
/// InputError that names the key, such as "bodies[1].pivots"; ResourceError where a file cannot be
/// read; UsageError for options that contradict a file.
std::vector<Body> read_vehicle(const std::filesystem::path& file, const std::vector<Pose>& path,
                               const VehicleOptions& options = {},
                               std::vector<Message>* warnings = nullptr);

}  // namespace clearway
