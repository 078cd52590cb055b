#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "clearway/file_unit.hpp"
#include "core/trajectory/follow/follow_path.hpp"
#include "io/json/key_reader.hpp"

namespace clearway {

/// A body as a vehicle's file names it, before its model is read. Files are relative to that file.
struct BodyEntry {
  KeyReader at;  ///< for complaints
  std::string name;
  std::filesystem::path model;
  FileUnit model_unit = {};          ///< none: as the command says
  BodyMount mount = BodyStation{0};  ///< unless it has a trajectory
  std::filesystem::path trajectory;  ///< empty: it follows the path
};

/// Reads a vehicle's JSON file (docs/guide/vehicles.md). environment_unit: metres of the unit
/// that stations become. Throws InputError naming the key, as "bodies[1].pivots", ResourceError
/// where the file cannot be read.
std::vector<BodyEntry> read_vehicle_file(const std::filesystem::path& path,
                                         double environment_unit);

}  // namespace clearway
