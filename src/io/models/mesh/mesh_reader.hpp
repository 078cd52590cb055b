#pragma once

#include <filesystem>
#include <optional>

#include "io/files/file.hpp"
#include "io/models/mesh/mesh_builder.hpp"
#include "io/scans/input_buffer.hpp"

namespace clearway {

enum class MeshFormat { kStl, kObj, kOff, kPly };

/// The format of a file that may hold a mesh, by its content first and otherwise by the ending of
/// its name; nullopt for formats of points. For formats of meshes and drawings that are not read it
/// throws InputError, which says what to do.
std::optional<MeshFormat> mesh_format_of(const File& file, const std::filesystem::path& path);

/// Reads a whole mesh, with as many vertices and triangles as the file really holds. Polygons are
/// cut into triangles. Malformed input throws InputError with line or byte, and what was expected.
/// The input must stand at its first byte and be able to seek.
MeshFile read_mesh(InputBuffer input, MeshFormat format);

/// Reads a whole mesh of the named format, with the conditions and exceptions of read_mesh().
MeshFile read_stl(InputBuffer input);
MeshFile read_obj(InputBuffer input);
MeshFile read_off(InputBuffer input);
/// Reads the vertices and faces of a PLY file; there are no triangles where it has no faces.
MeshFile read_ply_mesh(InputBuffer input);

}  // namespace clearway
