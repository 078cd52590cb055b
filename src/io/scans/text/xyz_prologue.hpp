#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "io/scans/input_buffer.hpp"
#include "io/scans/point_reader.hpp"
#include "io/scans/text/point_blocks.hpp"

namespace clearway {

/// What a text file of points declares before its first point.
struct XyzPrologue {
  PointLine line;
  std::optional<std::uint64_t> declared_points;
  std::uint64_t count_line = 0;  ///< line of declared_points
  LengthUnit unit = LengthUnit::kUnknown;
  bool any_foot = false;   ///< see StatedCrs
  double height_unit = 0;  ///< see StatedCrs
  std::vector<Message> remarks;
};

/// Reads everything before the first point and leaves the input there. Throws InputError for a
/// file that is not a table of points.
XyzPrologue read_xyz_prologue(InputBuffer& input, const PointReadOptions& options);

}  // namespace clearway
