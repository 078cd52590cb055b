#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

#include "clearway/file_unit.hpp"
#include "clearway/progress.hpp"
#include "clearway/vec3.hpp"

namespace clearway {

/// What the file of a model is searched as. The surface of a mesh becomes points only where the
/// caller asks for points, because a search of points can miss what comes closer to the surface.
enum class ModelAs {
  /// A mesh as its surface, and any other file as its points. With ModelOptions::spacing or
  /// ModelOptions::vertices_only the same as kPoints.
  kAuto,
  kPoints,   ///< samples of a mesh's surface, or the points of the file
  kSurface,  ///< the triangles of a mesh; a file without any is refused
  kSolid,    ///< as kSurface, and what its closed parts enclose; without any it is refused
};

struct ModelOptions {
  ModelAs as = ModelAs::kAuto;
  /// Largest gap between the samples of a mesh, metres: no place of its surface is farther than
  /// this from a model point. A point that the search finds touches the surface; one that it
  /// misses may be as close to the surface as radius - spacing. 0: a quarter of `radius`.
  double spacing = 0;
  /// The unit of the file, for example kMetresPerMillimetre or FileUnit::named("us-ft"); none: as
  /// the file declares, and where it does not, coordinates are taken as they are.
  FileUnit unit = {};
  /// Metres of the environment's unit, as Store::metres_per_unit() has them, into which a known
  /// unit is converted.
  double environment_unit = 1;
  /// Takes the vertices of a mesh alone, and not its surface.
  bool vertices_only = false;
  /// Leaves out the points whose z in the model's frame is below it, metres: wheels, for example,
  /// which stand on the ground. Triangles are cut there.
  std::optional<double> above = {};
  /// Radius of the search, metres, where it is known. The default of `spacing` follows from it, and
  /// whether the bent faces of a mesh are worth a warning. 0: not known, and a mesh that is to
  /// become points needs a spacing.
  double radius = 0;
  /// The environment names no unit, and environment_unit is assumed: a file in another unit is then
  /// warned of ("unit-assumed").
  bool environment_unit_is_assumed = false;

  /// Whether points are asked for in another way than by `as`.
  bool asks_for_points() const { return spacing > 0 || vertices_only; }
};

/// The spacing of a mesh's samples where a search of this radius names none.
inline double default_spacing(double radius) { return radius / 4; }

/// Points, or the corners of triangles and three indices a triangle.
struct ModelShape {
  std::vector<Vec3> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< none: the points are the model
  std::vector<std::uint32_t> solid_of = {};             ///< of kSolid: as Query has them
  double spacing = 0;                                   ///< as Query::model_spacing
};

/// Reads a model: points, of a scan's formats, or a mesh (STL, OBJ, PLY with faces, OFF). What a
/// mesh becomes is what options.as says. Corners are where the samples of kPoints are drawn from;
/// those that nothing uses are left out. Of kSolid those at one place are one; a height as
/// options.above would leave solids open, and throws UsageError. Throws InputError for malformed
/// files, for a model without points, for coordinates that are not finite, and for a mesh that is
/// to become points without a spacing; UsageError for options that contradict each other.
/// messages: where given, notes and warnings are appended ("mesh-bent-faces",
/// "mesh-crossing-faces", "loose-vertices").
ModelShape read_model_shape(const std::filesystem::path& path, const ModelOptions& options = {},
                            std::vector<Message>* messages = nullptr);

/// Reads a model as ModelAs::kPoints does, and returns the points alone. A search of them cannot
/// say how far the surface of a mesh may be from the points: read_model_shape() and set_model()
/// keep that.
std::vector<Vec3> read_model(const std::filesystem::path& path, const ModelOptions& options,
                             std::vector<Message>* messages = nullptr);

/// Reads the points of a model with default options.
std::vector<Vec3> read_model(const std::filesystem::path& path,
                             std::vector<Message>* messages = nullptr);

/// Makes a shape the model of a Query or of a Body.
template <typename Owner>
void set_model(Owner& owner, ModelShape shape) {
  owner.model = std::move(shape.points);
  owner.triangles = std::move(shape.triangles);
  owner.solid_of = std::move(shape.solid_of);
  owner.model_spacing = shape.spacing;
}

}  // namespace clearway
