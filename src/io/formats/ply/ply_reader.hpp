#pragma once

#include <memory>

#include "io/formats/input_buffer.hpp"
#include "io/formats/ply/ply_header.hpp"
#include "io/formats/point_reader.hpp"

namespace clearway {

/// Reads the vertices of a PLY file from its start. Elements before them are skipped. Those behind
/// them are not looked at: nobody reads them. Where there are none, the file must end with its last
/// vertex. Coordinates may have any scalar type; in an ASCII file they count as written, whatever
/// their type. The input must be able to seek.
std::unique_ptr<PointReader> read_ply(InputBuffer input);

/// The same behind the header.
std::unique_ptr<PointReader> read_binary_ply(InputBuffer input, PlyHeader header);
std::unique_ptr<PointReader> read_ascii_ply(InputBuffer input, PlyHeader header);

}  // namespace clearway
