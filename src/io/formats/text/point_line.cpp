#include "io/formats/text/point_line.hpp"

#include <algorithm>
#include <charconv>

#include "io/formats/text/column_names.hpp"
#include "io/formats/text/text_number.hpp"

namespace clearway {
namespace {

/// Whether a field is digits with one comma between them, perhaps after a sign.
bool has_decimal_comma(std::string_view field) {
  if (field.starts_with('-') || field.starts_with('+')) field.remove_prefix(1);
  const std::size_t comma = field.find(',');
  const auto is_digit = [](char c) { return (c >= '0' && c <= '9') || c == ','; };
  return comma != std::string_view::npos && comma > 0 && comma + 1 < field.size() &&
         field.find(',', comma + 1) == std::string_view::npos &&
         std::all_of(field.begin(), field.end(), is_digit);
}

}  // namespace

bool parse_point(std::string_view line, Vec3& point) {
  const char* at = line.data();
  const char* const end = at + line.size();
  char first = 0;
  if (!parse_number(at, end, point.x) || (first = skip_separator(at, end)) == 0 ||
      !parse_number(at, end, point.y) || skip_separator(at, end) != first ||
      !parse_number(at, end, point.z)) {
    return false;
  }
  if (at == end) return true;
  const char behind = skip_separator(at, end);
  return behind == first || behind == ' ';
}

std::optional<std::uint64_t> count_in(std::string_view line) {
  while (!line.empty() && is_blank(line.back())) line.remove_suffix(1);
  std::uint64_t value = 0;
  const char* const end = line.data() + line.size();
  const auto [stop, error] = std::from_chars(line.data(), end, value);
  if (error != std::errc() || stop != end) return std::nullopt;
  return value;
}

std::uint64_t most_points_in_rest(const InputBuffer& input) {
  // Bytes of "0 0 0" and a line break, which the last line may lack.
  constexpr std::uint64_t kShortest = 6;
  return (*input.size() - input.position() + 1) / kShortest;
}

bool PointLine::parse(std::string_view line, Vec3& point) {
  if (columns_ == kFirstThree) return parse_point(line, point);
  split_fields(line, separator_, fields_);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (columns_[axis] >= fields_.size()) return false;
    const auto value = parse_whole_number(fields_[columns_[axis]]);
    if (!value) return false;
    point[static_cast<int>(axis)] = *value;
  }
  return true;
}

std::string_view without_leading_blanks(std::string_view line) {
  const char* const end = line.data() + line.size();
  const char* const start = skip_blanks(line.data(), end);
  return {start, static_cast<std::size_t>(end - start)};
}

bool is_text_comment(std::string_view line) {
  return line.empty() || line.front() == '#' || line.starts_with("//");
}

bool next_data_line(InputBuffer& input, std::string_view& line) {
  do {
    if (!input.next_line(line)) return false;
    line = without_leading_blanks(line);
  } while (is_text_comment(line));
  return true;
}

char separator_of(std::string_view line) {
  const char* at = line.data();
  const char* const end = at + line.size();
  double number = 0;
  if (parse_number(at, end, number)) {
    if (const char separator = skip_separator(at, end)) return separator;
  }
  return line.find(';') != std::string_view::npos   ? ';'
         : line.find(',') != std::string_view::npos ? ','
                                                    : ' ';
}

std::size_t count_fields(std::string_view line) {
  std::vector<std::string_view> fields;
  split_fields(line, separator_of(line), fields);
  return fields.size();
}

std::string decimal_commas_in(std::string_view line) {
  std::vector<std::string_view> fields;
  split_fields(line, line.find(';') != std::string_view::npos ? ';' : ' ', fields);
  const auto found = std::count_if(fields.begin(), fields.end(), has_decimal_comma);
  return found > 1 ? " has decimal commas, which are not read; write decimal points" : "";
}

}  // namespace clearway
