#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "clearway/file_unit.hpp"
#include "core/trajectory/follow/follow_path.hpp"
#include "io/files/json.hpp"

namespace clearway {

/// A body as described in a vehicle's file, before its model is read. Paths are relative to that
/// file.
struct BodyEntry {
  KeyReader at;  ///< key of the body, for errors
  std::string name;
  std::filesystem::path model;
  FileUnit model_unit = {};  ///< unit of the model's file; where not known, that of the command
  BodyMount mount = BodyStation{0};  ///< used unless there is a trajectory
  /// Trajectory of its own; empty where the body follows the path.
  std::filesystem::path trajectory;
};

/// Reads a vehicle's JSON file (docs/guide/vehicles.md). environment_unit: metres of the unit in
/// which stations are returned. Throws InputError that names the key, as in "bodies[1].pivots", and
/// ResourceError where the file cannot be read.
std::vector<BodyEntry> read_vehicle_file(const std::filesystem::path& path,
                                         double environment_unit);

}  // namespace clearway
