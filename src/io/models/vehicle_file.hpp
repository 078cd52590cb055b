#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "clearway/body.hpp"
#include "clearway/file_unit.hpp"
#include "clearway/vehicle.hpp"
#include "core/trajectory/follow/follow_path.hpp"
#include "io/files/json.hpp"

namespace clearway {

/// A body as described in a vehicle's file, before its model is read. Paths are relative to that
/// file.
struct BodyEntry {
  KeyReader at;  ///< key of the body, for errors
  std::string name;
  std::filesystem::path model;  ///< its file, or a box that is named by its size
  FileUnit model_unit = {};     ///< unit of the model's file; where not known, that of the command
  BodyMount mount = BodyStation{0};
  std::optional<double> floor = {};  ///< see Body, in the environment's unit
  std::filesystem::path trajectory;  ///< file of the poses of a body with BodyOwnPoses; else empty

  /// The files that the body is read from: of its model, unless that is a box, and of its poses.
  std::vector<std::filesystem::path> files() const;
};

/// Reads a vehicle's JSON file (docs/guide/vehicles.md). environment_unit: metres of the unit in
/// which stations are returned. Throws InputError that names the key, as in "bodies[1].pivots", and
/// ResourceError where the file cannot be read.
std::vector<BodyEntry> read_vehicle_file(const std::filesystem::path& path,
                                         double environment_unit);

/// Reads the vehicle's file and returns one of its bodies without a model, with the poses that it
/// has while the vehicle follows `path`, as read_vehicle() does. Reads no model, and trajectories
/// only of that body and its towers. followed: receives what is odd at poses, as lists of the
/// path's poses. Throws what read_vehicle() throws, and UsageError where no body has the name.
Body place_body(const std::filesystem::path& file, const std::string& name,
                const std::vector<Pose>& path, const VehicleOptions& options,
                std::vector<Message>* warnings, FollowedPath& followed);

}  // namespace clearway
