#pragma once

#include <memory>

#include "io/formats/input_buffer.hpp"
#include "io/formats/ply/ply_header.hpp"
#include "io/formats/point_reader.hpp"

namespace clearway {

/// Reads the vertices of a PLY file from its start. Elements before them are skipped; elements
/// behind them are not read, and where there are none, the file must end with its last vertex.
/// Coordinates may have any scalar type; in an ASCII file they count as written, whatever their
/// type. The input must be able to seek.
std::unique_ptr<PointReader> read_ply(InputBuffer input);

/// Reads the vertices of a binary PLY file whose header has been read.
std::unique_ptr<PointReader> read_binary_ply(InputBuffer input, PlyHeader header);
std::unique_ptr<PointReader> read_ascii_ply(InputBuffer input, PlyHeader header);

}  // namespace clearway
