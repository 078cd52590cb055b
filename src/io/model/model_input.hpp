#pragma once

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
  double declared_unit = 0;       ///< metres; 0 where the file does not say

  bool is_mesh() const { return !mesh.triangles.empty(); }
};

/// Reads a file that has one vertex or point at least; everything is finite in the environment's
/// unit too. Throws InputError, and UsageError for units that are not above 0.
ModelInput read_model_input(const std::filesystem::path& path, const ModelOptions& options);

/// Tells how far the corners of a polygon lie beside its plane, where that is not small beside
/// `allowed` metres; of_what: what that is, for people.
void tell_bend(const ModelInput& input, double allowed, const std::string& of_what,
               std::vector<Message>& messages);

/// Its points as the options ask: samples of a mesh, or all its vertices. Throws InputError as
/// sample_mesh does, and for a mesh without a spacing. Notes and warnings are appended.
std::vector<Vec3> points_of(const ModelInput& input, const ModelOptions& options,
                            std::vector<Message>& messages);

}  // namespace clearway
