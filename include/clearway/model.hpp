#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "clearway/progress.hpp"
#include "clearway/vec3.hpp"

namespace clearway {

/// Units in metres; inch and foot are defined so.
inline constexpr double kMetresPerMillimetre = 0.001, kMetresPerCentimetre = 0.01,
                        kMetresPerInch = 0.0254, kMetresPerFoot = 0.3048;

struct ModelOptions {
  /// Of a mesh, metres: no place of its surface is farther than this from a model point. So a point
  /// that the search finds touches the surface, and one that it misses is between
  /// radius - spacing and radius away. 0: none given, and a mesh is refused.
  double spacing = 0;
  /// Metres of a unit of the file; 0: as the file declares, and where it does not, coordinates are
  /// taken as they are.
  double unit = 0;
  /// Metres of the environment's unit, into which a known unit is converted.
  double environment_unit = 1;
  /// Takes the vertices of a mesh alone, and not its surface.
  bool vertices_only = false;
  /// Leaves out the points whose z in the model's frame is below it, metres: wheels, for example,
  /// which stand on the ground.
  std::optional<double> above = {};
};

/// Reads a model: points, of a scan's formats, or a mesh (STL, OBJ, PLY with faces, OFF), whose
/// surface is sampled to points. Throws InputError for malformed files, for a model without points,
/// for coordinates that are not finite, and for a mesh without a spacing. messages: where given,
/// notes and warnings are appended ("mesh-bent-faces", "mesh-crossing-faces").
std::vector<Vec3> read_model(const std::filesystem::path& path, const ModelOptions& options,
                             std::vector<Message>* messages = nullptr);

/// The same with default options.
std::vector<Vec3> read_model(const std::filesystem::path& path,
                             std::vector<Message>* messages = nullptr);

}  // namespace clearway
