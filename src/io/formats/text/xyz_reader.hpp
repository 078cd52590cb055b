#pragma once

#include <memory>
#include <vector>

#include "io/formats/input_buffer.hpp"
#include "io/formats/point_reader.hpp"

namespace clearway {

/// Reads text with one point per line: x y z and anything behind them, separated by blanks, commas
/// or semicolons (one kind within a line, so that decimal commas are refused). Blank lines and
/// lines that start with # or // are comments. The first other line may be the number of points
/// (PTS): exactly so many follow, perhaps followed by another such number with its points. A header
/// line that names the columns tells where x, y and z are; so does a comment that fits the lines.
/// Text without names that looks like something else than points is refused, unless the options
/// choose the columns. `remarks` come before the reader's own. The input must be able to seek.
std::unique_ptr<PointReader> read_xyz(InputBuffer input, const PointReadOptions& options = {},
                                      std::vector<Message> remarks = {});

}  // namespace clearway
