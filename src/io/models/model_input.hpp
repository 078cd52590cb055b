#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "clearway/model.hpp"
#include "io/models/mesh/mesh_builder.hpp"

namespace clearway {

/// Contents of a model's file in the environment's unit: vertices and triangles of a mesh, or
/// points alone.
struct ModelInput {
  std::filesystem::path path;
  TriangleMesh mesh;  ///< the mesh; without triangles, its vertices are points
  MeshRemarks remarks;
  std::vector<Message> messages;  ///< messages on the file as a whole
  FileUnit declared_unit = {};    ///< unit that the file declares; not known where it declares none
  /// Spacing of points that `clearway model` sampled from a mesh (Query::model_spacing); otherwise
  /// 0.
  double sampled_spacing = 0;
  /// The triangles of a mesh of which only the vertices are wanted. They do not belong to the
  /// model, but show how far its surface is from the vertices.
  std::vector<std::array<std::uint32_t, 3>> between_vertices;

  bool is_mesh() const { return !mesh.triangles.empty(); }
};

/// Whether a model is named by its size, as "box:LENGTH,WIDTH,HEIGHT", and not by a file.
bool names_box(const std::filesystem::path& model);

/// Reads a model's file, or makes the box that is named instead of one. A file must have at least
/// one vertex or point; all coordinates are finite in the environment's unit too. Throws
/// InputError, and UsageError for units that are not above 0.
ModelInput read_model_input(const std::filesystem::path& path, const ModelOptions& options);

/// Adds a message on how far corners of a polygon are from its plane, where that is not small
/// compared with `allowed` metres. of_what: what `allowed` is, in words.
void tell_bend(const ModelInput& input, double allowed, const std::string& of_what,
               std::vector<Message>& messages);

/// The contents of a mesh's file in words: "12 triangles, 3 line segments and 1 single point".
std::string contents_of(const ModelInput& input);

/// The warning that a mesh has vertices which nothing refers to.
Message loose_vertices_warning(const ModelInput& input, std::uint64_t vertices);

/// Throws UsageError for parallel axes, and where options of points are combined with a surface.
void check_model_options(const ModelOptions& options);

/// The points of a file that the options ask for: samples of a mesh, or all its vertices; the model
/// has the spacing of a mesh. Throws InputError as sample_mesh() does, and for a mesh without a
/// spacing. Appends notes and warnings to `messages`.
Model points_of(const ModelInput& input, const ModelOptions& options,
                std::vector<Message>& messages);

}  // namespace clearway
