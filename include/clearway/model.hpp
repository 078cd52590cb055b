#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "clearway/progress.hpp"
#include "clearway/vec3.hpp"

namespace clearway {

/// Units in metres; inch and foot are defined so.
inline constexpr double kMetresPerMillimetre = 0.001, kMetresPerCentimetre = 0.01,
                        kMetresPerInch = 0.0254, kMetresPerFoot = 0.3048;

enum class ModelAs {
  kPoints,         ///< samples of a mesh's surface, or the points of the file
  kSurface,        ///< the triangles of a mesh; a file without any is refused
  kSurfaceOfMesh,  ///< the same of a mesh, and the points of any other file
  kSolid,          ///< as kSurface, and what its closed parts enclose; without any it is refused
};

struct ModelOptions {
  /// For read_model_shape().
  ModelAs as = ModelAs::kPoints;
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
  /// which stand on the ground. Triangles are cut there.
  std::optional<double> above = {};
};

/// Reads a model: points, of a scan's formats, or a mesh (STL, OBJ, PLY with faces, OFF), whose
/// surface is sampled to points. Throws InputError for malformed files, for a model without points,
/// for coordinates that are not finite, and for a mesh without a spacing. messages: where given,
/// notes and warnings are appended ("mesh-bent-faces", "mesh-crossing-faces").
std::vector<Vec3> read_model(const std::filesystem::path& path, const ModelOptions& options,
                             std::vector<Message>* messages = nullptr);

/// Points, or the corners of triangles and three indices a triangle.
struct ModelShape {
  std::vector<Vec3> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< none: the points are the model
  std::vector<std::uint32_t> solid_of = {};             ///< of kSolid: as Query has them
};

/// The same, as options.as says. Corners are where the samples of kPoints are drawn from; those
/// that no triangle uses are left out. Of kSolid those at one place are one; a height as
/// options.above would leave solids open, and throws UsageError.
ModelShape read_model_shape(const std::filesystem::path& path, const ModelOptions& options,
                            std::vector<Message>* messages = nullptr);

/// As read_model above, with default options.
std::vector<Vec3> read_model(const std::filesystem::path& path,
                             std::vector<Message>* messages = nullptr);

}  // namespace clearway
