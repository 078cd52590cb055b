#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "clearway/progress.hpp"
#include "clearway/vec3.hpp"
#include "io/formats/input_buffer.hpp"

/// The lines that PTX and PTS consist of.
namespace clearway {

/// What the first lines of a text with points say of it.
enum class CountLines {
  kNone,  ///< no count: XYZ
  kOne,   ///< the number of points: PTS
  kTwo,   ///< columns and rows of a scan: PTX
};

/// Looks at the start of the input and goes back to it. Throws InputError for a line that is too
/// long.
CountLines find_count_lines(InputBuffer& input);

/// The next line that is neither blank nor a comment (# or //), without blanks around it; false at
/// the end.
bool next_scan_line(InputBuffer& input, std::string_view& line);

/// A line of nothing but a whole number from 0.
std::optional<std::uint64_t> count_in(std::string_view line);

/// At most as many points can stand in the rest of the input: each takes a line.
std::uint64_t most_scan_points(const InputBuffer& input);

/// x y z and anything behind them, in blanks, commas or semicolons; false for anything else.
/// more: whether anything follows, so that z is surely complete.
bool parse_scan_point(std::string_view line, Vec3& point, bool& more);

/// The warning of a file whose last number is its last byte.
Message last_number_may_be_cut(const std::string& name, std::uint64_t line);

}  // namespace clearway
