#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <utility>
#include <vector>

#include "clearway/axis.hpp"
#include "clearway/file_unit.hpp"
#include "clearway/progress.hpp"
#include "clearway/vec3.hpp"

namespace clearway {

/// Entry of Model::solid_of for a triangle that belongs to no solid.
inline constexpr std::uint32_t kNoSolid = 0xffffffff;

/// What moves through the environment: points, or the surface of triangles, some of which may form
/// closed solids. Coordinates are in metres, in the model's own frame.
struct Model {
  Model() = default;
  Model(std::vector<Vec3> points)  // NOLINT(google-explicit-constructor): points are a model too
      : vertices(std::move(points)) {}
  Model(std::initializer_list<Vec3> points) : vertices(points) {}
  Model(std::vector<Vec3> corners, std::vector<std::array<std::uint32_t, 3>> surface,
        std::vector<std::uint32_t> solids = {})
      : vertices(std::move(corners)), triangles(std::move(surface)), solid_of(std::move(solids)) {}

  std::vector<Vec3> vertices;  ///< the points, or the corners of the triangles
  /// Triangles as three indices of vertices each; the model is their surface. If empty, the model
  /// is its points.
  std::vector<std::array<std::uint32_t, 3>> triangles;
  /// Number of each triangle's solid, from 0, or kNoSolid; points inside a solid collide too. The
  /// triangles of a solid are closed: each edge is used as often in one direction as in the other,
  /// by vertices of the same values. If empty, nothing has an inside.
  std::vector<std::uint32_t> solid_of;
  /// Largest gap between the samples of a mesh, in metres: no place of its surface is farther than
  /// this from a point of the model. The surface may therefore come closer than the radius, by as
  /// much, to a point that does not collide, and the answer says so. 0: the model is not a sampled
  /// mesh.
  double spacing = 0;
  /// The axes of the model's file that pointed ahead and up before the model was turned. A result
  /// keeps them, so that the file is turned again when it is read for the result.
  ModelAxes file_axes = {};

  bool empty() const { return vertices.empty(); }
  bool is_surface() const { return !triangles.empty(); }
  bool is_solid() const { return !solid_of.empty(); }  ///< true only for a surface

  /// Number of triangles of a surface, or of points.
  std::uint64_t element_count() const { return is_surface() ? triangles.size() : vertices.size(); }

  /// Number of solids: one more than the greatest number in solid_of.
  std::uint64_t solid_count() const {
    std::uint64_t count = 0;
    for (const std::uint32_t solid : solid_of) {
      if (solid != kNoSolid && solid >= count) count = solid + std::uint64_t{1};
    }
    return count;
  }

  friend bool operator==(const Model&, const Model&) = default;
};

/// What the file of a model is searched as. A mesh's surface becomes points only if the caller asks
/// for points, because a search of points can miss what comes closer to the surface.
enum class ModelAs {
  /// A mesh all of whose parts are closed as kSolid, any other mesh as kSurface, and other files as
  /// their points. With ModelOptions::spacing or ModelOptions::vertices_only it means kPoints.
  kAuto,
  kPoints,   ///< samples of a mesh's surface, or the points of the file
  kSurface,  ///< the triangles of a mesh; a file without any is refused
  /// The triangles and what their closed parts enclose; a file without closed parts is refused
  kSolid,
};

struct ModelOptions {
  ModelAs as = ModelAs::kAuto;
  /// Largest gap between the samples of a mesh, metres: no place of its surface is farther than
  /// this from a model point. A point that the search finds touches the surface; one that it
  /// misses may be as close to the surface as radius - spacing. 0: a quarter of `radius`.
  double spacing = 0;
  /// The unit of the file, for example kMetresPerMillimetre or FileUnit::named("us-ft"). None: the
  /// unit that the file declares; if it declares none, coordinates are taken as they are.
  FileUnit unit = {};
  /// Length of the environment's unit in metres, as Store::metres_per_unit() returns it. Models in
  /// a known unit are converted to it.
  double environment_unit = 1;
  /// The axes of the file that point ahead and up; must not be parallel. The model is turned so
  /// that x points ahead, y to the left and z up. The other options are about the turned model.
  Axis forward = Axis::kPlusX, up = Axis::kPlusZ;
  /// Takes only the vertices of a mesh, without its surface.
  bool vertices_only = false;
  /// Radius of the search in metres, if it is known. It sets the default of `spacing`, and whether
  /// the bent faces of a mesh are worth a warning. 0: not known; then a mesh that is to become
  /// points needs a spacing.
  double radius = 0;
  /// Whether environment_unit is only assumed because the environment names no unit. A file in
  /// another unit then gives the warning "unit-assumed".
  bool environment_unit_is_assumed = false;

  /// Whether an option other than `as` asks for points.
  bool asks_for_points() const { return spacing > 0 || vertices_only; }
};

/// Default spacing of a mesh's samples for a search radius, both in metres.
inline double default_spacing(double radius) { return radius / 4; }

/// Reads a model from points, in the formats of scans, or from a mesh (STL, OBJ, PLY with faces,
/// OFF). options.as says what a mesh becomes. The corners of a surface are the vertices from which
/// kPoints draws its samples, without those that no face uses. For kSolid, corners at the same
/// place become one. Throws InputError for malformed files, for a model without points, for
/// coordinates that are not finite, and for a mesh that is to become points without a spacing;
/// UsageError for options that contradict each other. messages: where given, notes and warnings are
/// appended
/// ("mesh-bent-faces", "mesh-crossing-faces", "loose-vertices").
Model read_model(const std::filesystem::path& path, const ModelOptions& options = {},
                 std::vector<Message>* messages = nullptr);

/// Reads a model as ModelAs::kPoints does, and returns only its points. A search of them cannot say
/// how far the surface of a mesh may be from the points; Model::spacing of read_model() can.
std::vector<Vec3> read_model_points(const std::filesystem::path& path, const ModelOptions& options,
                                    std::vector<Message>* messages = nullptr);

/// Reads the points of a model with default options.
std::vector<Vec3> read_model_points(const std::filesystem::path& path,
                                    std::vector<Message>* messages = nullptr);

}  // namespace clearway
