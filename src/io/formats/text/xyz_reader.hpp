#pragma once

#include <memory>
#include <vector>

#include "io/formats/input_buffer.hpp"
#include "io/formats/point_reader.hpp"

namespace clearway {

/// Reads text with one point a line: x y z and anything behind them, in blanks, commas or
/// semicolons (one kind within a line, so that decimal commas are refused). Blank lines and lines
/// that start with # or // are comments. The first other line may be the number of points (PTS):
/// exactly so many follow, and then perhaps such a number and points again. A header line that
/// names the columns says where x, y and z stand; so does a comment that fits the lines. Text
/// without names that looks like something else than points is refused, unless the options choose
/// the columns. `remarks` come first. The input must be able to seek.
std::unique_ptr<PointReader> read_xyz(InputBuffer input, const PointReadOptions& options = {},
                                      std::vector<Message> remarks = {});

}  // namespace clearway
