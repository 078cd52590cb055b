#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "io/formats/input_buffer.hpp"
#include "io/formats/point_reader.hpp"
#include "io/formats/text/point_line.hpp"

namespace clearway {

/// What a text says before its first point.
struct XyzPrologue {
  PointLine line;
  std::optional<std::uint64_t> declared_points;
  std::uint64_t count_line = 0;  ///< where they are declared
  LengthUnit unit = LengthUnit::kUnknown;
  bool any_foot = false;  ///< see CloudInfo
  std::vector<Message> remarks;
};

/// Reads what stands before the first point, and leaves the input there. Throws InputError for a
/// text that is no table of points.
XyzPrologue read_xyz_prologue(InputBuffer& input, const PointReadOptions& options);

}  // namespace clearway
