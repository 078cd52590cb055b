#pragma once

#include <cstdint>

#include "io/scans/input_buffer.hpp"
#include "io/scans/point_reader.hpp"
#include "io/scans/text/point_blocks.hpp"

namespace clearway {

/// What a text file of points declares before its first point.
struct XyzPrologue {
  PointLine line = {};
  CloudInfo info = {};
  std::uint64_t count_line = 0;  ///< line of the number of points, where the file declares one
  /// Whether a last line that lacks values or digits is refused, see OpenEnd.
  bool refuses_cut = false;
};

/// Reads everything before the first point and leaves the input there. Throws InputError for a
/// file that is not a table of points.
XyzPrologue read_xyz_prologue(InputBuffer& input, const PointReadOptions& options);

}  // namespace clearway
