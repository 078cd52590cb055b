#pragma once

#include <memory>

#include "io/scans/input_buffer.hpp"
#include "io/scans/point_reader.hpp"

namespace clearway {

/// Reads the vertices of a PLY file from its start. Elements before them are skipped; elements
/// after them are not read, and where there are none, the file must end with its last vertex.
/// Coordinates may have any scalar type; in an ASCII file they count as written, whatever their
/// type. The input must be able to seek.
std::unique_ptr<PointReader> read_ply(InputBuffer input);

}  // namespace clearway
