#pragma once

#include <filesystem>
#include <optional>

#include "io/formats/input_buffer.hpp"
#include "io/formats/mesh/triangle_mesh.hpp"
#include "io/system/file.hpp"

namespace clearway {

enum class MeshFormat { kStl, kObj, kOff, kPly };

/// The format of a file that may hold a mesh, by its content first and by the ending of its name
/// otherwise; none for formats of points. Throws InputError for formats of meshes and drawings that
/// are not read, with what to do.
std::optional<MeshFormat> mesh_format_of(const File& file, const std::filesystem::path& path);

/// Reads a mesh whole: as many vertices and triangles as the file really holds. Polygons are cut
/// into triangles. Malformed input throws InputError with line or byte, and what was expected. The
/// input stands at its first byte and can seek.
MeshFile read_mesh(InputBuffer input, MeshFormat format);

/// The same for each format.
MeshFile read_stl(InputBuffer input);
MeshFile read_obj(InputBuffer input);
MeshFile read_off(InputBuffer input);
/// No triangles where the file has no faces.
MeshFile read_ply_mesh(InputBuffer input);

}  // namespace clearway
