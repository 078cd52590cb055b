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
  /// Of the models of all bodies; where a body has a model_unit, that one counts. Lengths of the
  /// file that have a unit become those of environment_unit.
  ModelOptions model = {};
  TrajectoryOptions trajectory = {};  ///< of bodies that have one of their own
  int threads = 0;                    ///< 0: all cores; the bodies do not depend on it
};

/// Reads the JSON file of a vehicle (docs/guide/vehicles.md), and the files that it names: its
/// bodies, in the file's order, at the poses that they have while the vehicle follows `path`. They
/// are what Query::bodies takes, `path` is Query::poses. warnings: where given, notes and warnings
/// of the files, and of what is missing or odd at poses, are appended. Throws InputError naming the
/// key, as "bodies[1].pivots"; ResourceError where a file cannot be read; UsageError for options
/// that contradict a file.
std::vector<Body> read_vehicle(const std::filesystem::path& file, const std::vector<Pose>& path,
                               const VehicleOptions& options = {},
                               std::vector<Message>* warnings = nullptr);

}  // namespace clearway
