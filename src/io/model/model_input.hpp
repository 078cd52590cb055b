#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "clearway/model.hpp"
#include "io/formats/mesh/triangle_mesh.hpp"

namespace clearway {

/// What a model's file holds, in the environment's unit: vertices and triangles of a mesh, or
/// points alone.
struct ModelInput {
  std::filesystem::path path;
  TriangleMesh mesh;  ///< no triangles: the vertices are points
  MeshRemarks remarks;
  std::vector<Message> messages;  ///< on the file as a whole
  FileUnit declared_unit = {};    ///< as the file says; none where it does not
  /// Of points that clearway model sampled from a mesh, as Query::model_spacing; otherwise 0.
  double sampled_spacing = 0;
  /// The triangles of a mesh whose vertices alone are asked for. They are no part of the model, and
  /// tell how far its surface is from the vertices.
  std::vector<std::array<std::uint32_t, 3>> between_vertices;

  bool is_mesh() const { return !mesh.triangles.empty(); }
};

/// Reads a file that has one vertex or point at least; everything is finite in the environment's
/// unit too. Throws InputError, and UsageError for units that are not above 0.
ModelInput read_model_input(const std::filesystem::path& path, const ModelOptions& options);

/// Tells how far the corners of a polygon lie beside its plane, where that is not small beside
/// `allowed` metres; of_what: what that is, for people.
void tell_bend(const ModelInput& input, double allowed, const std::string& of_what,
               std::vector<Message>& messages);

/// "12 triangles, 3 line segments and 1 single point": what the file of a mesh draws.
std::string contents_of(const ModelInput& input);

/// The warning that a mesh has vertices which nothing refers to.
Message loose_vertices_warning(const ModelInput& input, std::uint64_t vertices);

/// Throws UsageError for options of points together with a surface.
void check_model_options(const ModelOptions& options);

/// What a file is searched as, never kAuto: the one rule of what a mesh becomes.
ModelAs resolved_kind(const ModelInput& input, const ModelOptions& options);

/// The points of a file as the options ask: samples of a mesh, or all its vertices; with the
/// spacing of a mesh. Throws InputError as sample_mesh does, and for a mesh without a spacing.
/// Notes and warnings are appended.
Model points_of(const ModelInput& input, const ModelOptions& options,
                std::vector<Message>& messages);

}  // namespace clearway
