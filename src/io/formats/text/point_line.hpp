#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "clearway/vec3.hpp"
#include "io/formats/input_buffer.hpp"
#include "io/formats/text/table_header.hpp"

namespace clearway {

inline constexpr CoordinateColumns kFirstThree{0, 1, 2};

/// Parses the lines of a text: the columns of x, y and z, and their separator.
class PointLine {
 public:
  PointLine() = default;
  /// separator: ',', ';' or ' '.
  PointLine(const CoordinateColumns& columns, char separator)
      : columns_(columns), separator_(separator) {}

  const CoordinateColumns& columns() const { return columns_; }
  /// Parses a line without leading blanks; returns false where it is anything else than a point.
  bool parse(std::string_view line, Vec3& point);

 private:
  CoordinateColumns columns_ = kFirstThree;
  char separator_ = ' ';  ///< separator; not used for the first three columns
  std::vector<std::string_view> fields_;
};

/// Parses x, y and z in the first three columns, followed by anything, separated by blanks, commas
/// or semicolons. Returns false for anything else. line: without leading blanks.
bool parse_point(std::string_view line, Vec3& point);

/// The value of a line that is nothing but a whole number from 0. line: without leading blanks.
std::optional<std::uint64_t> count_in(std::string_view line);

/// Upper bound of the number of points in the rest of the input, as each takes a line.
std::uint64_t most_points_in_rest(const InputBuffer& input);

/// The line number of each of `points`, which are ascending numbers counted from 0. next_point:
/// advances the input, which stands before the first point, by one point; returns false at the end.
template <typename NextPoint>
std::vector<std::uint64_t> lines_of_points(std::span<const std::uint64_t> points,
                                           const InputBuffer& input, NextPoint next_point) {
  std::vector<std::uint64_t> lines;
  for (std::uint64_t i = 0; lines.size() < points.size() && next_point(); ++i) {
    if (i == points[lines.size()]) lines.push_back(input.line());
  }
  return lines;
}

std::string_view without_leading_blanks(std::string_view line);

/// Whether a line is blank or starts with # or //. line: without leading blanks.
bool is_text_comment(std::string_view line);

/// Reads the next line that is neither blank nor a comment, without leading blanks; returns false
/// at the end.
bool next_data_line(InputBuffer& input, std::string_view& line);

/// The separator of the fields of a line of data: ',', ';' or ' ' for any blanks.
char separator_of(std::string_view line);

/// The number of fields of a line, separated by separator_of(line).
std::size_t count_fields(std::string_view line);

/// For the message about a refused line: half a sentence where its numbers have decimal commas,
/// otherwise empty.
std::string decimal_commas_in(std::string_view line);

}  // namespace clearway
