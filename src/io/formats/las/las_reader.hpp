#pragma once

#include <memory>

#include "io/formats/input_buffer.hpp"
#include "io/formats/point_reader.hpp"

namespace clearway {

/// Reads LAS 1.0 to 1.4, every point format, from the input's start. Where the input can seek, what
/// the header declares is checked against the file's size at once, extended records included. Of a
/// stream a missing byte shows when it is reached; its extended records are read behind the last
/// point, so that a CRS that only they hold is in info() once read() has returned false.
std::unique_ptr<PointReader> read_las(InputBuffer input);

}  // namespace clearway
