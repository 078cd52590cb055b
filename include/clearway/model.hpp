#pragma once

#include <filesystem>
#include <vector>

#include "clearway/progress.hpp"
#include "clearway/vec3.hpp"

namespace clearway {

/// Reads a model point cloud: LAS, PLY or XYZ text. Throws InputError for malformed files, for a
/// model without points and for coordinates that are not finite. warnings: where given, they are
/// appended (code "mesh-faces": the file is a mesh, and only its vertices are the model).
std::vector<Vec3> read_model(const std::filesystem::path& path,
                             std::vector<Message>* warnings = nullptr);

}  // namespace clearway
