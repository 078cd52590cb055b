#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <utility>
#include <vector>

#include "clearway/file_unit.hpp"
#include "clearway/progress.hpp"
#include "clearway/vec3.hpp"

namespace clearway {

/// The solid of a triangle that belongs to none.
inline constexpr std::uint32_t kNoSolid = 0xffffffff;

/// What moves through the environment: points, or the surface of triangles, of which some may be
/// closed solids. In a frame of its own, metres.
struct Model {
  Model() = default;
  Model(std::vector<Vec3> points)  // NOLINT(google-explicit-constructor): points are a model too
      : vertices(std::move(points)) {}
  Model(std::initializer_list<Vec3> points) : vertices(points) {}
  Model(std::vector<Vec3> corners, std::vector<std::array<std::uint32_t, 3>> surface,
        std::vector<std::uint32_t> solids = {})
      : vertices(std::move(corners)), triangles(std::move(surface)), solid_of(std::move(solids)) {}

  std::vector<Vec3> vertices;  ///< the points, or the corners of the triangles
  /// Three indices of vertices each: the model is their surface. None: it is its points.
  std::vector<std::array<std::uint32_t, 3>> triangles;
  /// The number of each triangle's solid, from 0, or kNoSolid: what is inside collides too. The
  /// triangles of a solid are closed: each edge is used as often in one direction as in the other,
  /// by vertices of the same values. None: nothing has an inside.
  std::vector<std::uint32_t> solid_of;
  /// Metres. The points are samples of a mesh, and no place of its surface is farther than this
  /// from one of them; so the surface may come closer than the radius, by as much, to a point that
  /// does not collide. The answer says so. 0: the model is no sampled mesh.
  double spacing = 0;

  bool empty() const { return vertices.empty(); }
  bool is_surface() const { return !triangles.empty(); }
  bool is_solid() const { return !solid_of.empty(); }  ///< then it is a surface too

  /// How many triangles a surface has, or how many points.
  std::uint64_t element_count() const { return is_surface() ? triangles.size() : vertices.size(); }

  /// One more than the greatest number of a solid.
  std::uint64_t solid_count() const {
    std::uint64_t count = 0;
    for (const std::uint32_t solid : solid_of) {
      if (solid != kNoSolid && solid >= count) count = solid + std::uint64_t{1};
    }
    return count;
  }

  friend bool operator==(const Model&, const Model&) = default;
};

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

/// Reads a model: points, of a scan's formats, or a mesh (STL, OBJ, PLY with faces, OFF). What a
/// mesh becomes is what options.as says. Corners are where the samples of kPoints are drawn from;
/// those that nothing uses are left out. Of kSolid those at one place are one; a height as
/// options.above would leave solids open, and throws UsageError. Throws InputError for malformed
/// files, for a model without points, for coordinates that are not finite, and for a mesh that is
/// to become points without a spacing; UsageError for options that contradict each other.
/// messages: where given, notes and warnings are appended ("mesh-bent-faces",
/// "mesh-crossing-faces", "loose-vertices").
Model read_model(const std::filesystem::path& path, const ModelOptions& options = {},
                 std::vector<Message>* messages = nullptr);

/// Reads a model as ModelAs::kPoints does, and returns the points alone. A search of them cannot
/// say how far the surface of a mesh may be from the points; Model::spacing of read_model() can.
std::vector<Vec3> read_model_points(const std::filesystem::path& path, const ModelOptions& options,
                                    std::vector<Message>* messages = nullptr);

/// Reads the points of a model with default options.
std::vector<Vec3> read_model_points(const std::filesystem::path& path,
                                    std::vector<Message>* messages = nullptr);

}  // namespace clearway
