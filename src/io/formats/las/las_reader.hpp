#pragma once

#include <memory>

#include "io/formats/input_buffer.hpp"
#include "io/formats/point_reader.hpp"

namespace clearway {

/// Reads LAS 1.0 to 1.4, every point format, from the input's start. Where the input can seek, what
/// the header declares is checked against the file's size at once, extended records included: both
/// less and a whole record more are refused. Of a stream a missing byte shows when it is reached,
/// and what comes beyond the declared points is read as points, with a warning; its extended
/// records are read behind the last point, so that a CRS that only they hold is in info() once
/// read() has returned false. LAZ needs an input that can seek.
std::unique_ptr<PointReader> read_las(InputBuffer input);

}  // namespace clearway
