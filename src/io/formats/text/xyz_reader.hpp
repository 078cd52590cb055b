#pragma once

#include <memory>

#include "io/formats/input_buffer.hpp"
#include "io/formats/point_reader.hpp"

namespace clearway {

/// Reads text with one point a line: x y z and anything behind them, in blanks, commas or
/// semicolons (one kind within a line, so that decimal commas are refused). Blank lines and lines
/// that start with # or // are comments. The first other line may be the number of points (PTS),
/// which is then required, or a header that names the columns x, y and z wherever they stand; a
/// first comment `//X Y Z` that starts with these names in another order counts as well. The input
/// must be able to seek.
std::unique_ptr<PointReader> read_xyz(InputBuffer input);

}  // namespace clearway
