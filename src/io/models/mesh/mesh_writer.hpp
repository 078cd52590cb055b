#pragma once

#include <filesystem>

#include "clearway/model.hpp"
#include "io/files/file.hpp"

namespace clearway {

/// Writes the triangles of a model as text, in full precision: OFF, or PLY where the name of `path`
/// ends so. Throws UsageError where it ends in neither, and ResourceError.
void write_mesh(const Model& model, const std::filesystem::path& path, const File& file);

/// Throws UsageError as write_mesh() does.
void check_mesh_name(const std::filesystem::path& path);

}  // namespace clearway
