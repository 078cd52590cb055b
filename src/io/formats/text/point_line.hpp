#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "clearway/vec3.hpp"
#include "io/formats/input_buffer.hpp"
#include "io/formats/text/table_header.hpp"

namespace clearway {

inline constexpr CoordinateColumns kFirstThree{0, 1, 2};

/// Where the lines of a text hold x, y and z, and how they are parsed.
class PointLine {
 public:
  PointLine() = default;
  /// separator: ',', ';' or ' '.
  PointLine(const CoordinateColumns& columns, char separator)
      : columns_(columns), separator_(separator) {}

  const CoordinateColumns& columns() const { return columns_; }
  /// False where the line, which has no leading blanks, is anything else than a point.
  bool parse(std::string_view line, Vec3& point);

 private:
  CoordinateColumns columns_ = kFirstThree;
  char separator_ = ' ';  ///< not used for the first three columns
  std::vector<std::string_view> fields_;
};

std::string_view without_leading_blanks(std::string_view line);

/// Blank lines and those that start with # or //. line: without leading blanks.
bool is_text_comment(std::string_view line);

/// The next line that is neither blank nor a comment, without leading blanks; false at the end.
bool next_data_line(InputBuffer& input, std::string_view& line);

/// What separates the fields of a line of data: ',', ';' or ' ' for any blanks.
char separator_of(std::string_view line);

/// How many fields a line has, at separator_of() it.
std::size_t count_fields(std::string_view line);

/// For a refused line: a half sentence where its numbers have decimal commas, else nothing.
std::string decimal_commas_in(std::string_view line);

}  // namespace clearway
