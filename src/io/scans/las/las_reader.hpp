#pragma once

#include <memory>

#include "io/scans/input_buffer.hpp"
#include "io/scans/point_reader.hpp"

namespace clearway {

/// Reads LAS 1.0 to 1.4 in every point format, from the input's start. Where the input can seek,
/// the header's declarations, including extended records, are checked against the file's size at
/// once, and missing bytes are refused as well as surplus ones. In a stream, a missing byte is
/// noticed when it is reached, and whole records beyond the declared points are read as points,
/// with a warning. A stream's extended records are read after the last point, so that a CRS that
/// only they hold appears in info() once read() has returned false. LAZ needs an input that can
/// seek. with_times: see PointReadOptions.
std::unique_ptr<PointReader> read_las(InputBuffer input, bool with_times = false);

}  // namespace clearway
