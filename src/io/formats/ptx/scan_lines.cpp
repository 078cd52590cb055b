#include "io/formats/ptx/scan_lines.hpp"

#include <algorithm>
#include <charconv>

#include "io/formats/text/text_number.hpp"
#include "io/system/input_error.hpp"

namespace clearway {
namespace {

/// Between blanks, commas and semicolons.
std::size_t count_values(std::string_view line) {
  constexpr std::string_view kSeparators = " \t,;";
  std::size_t count = 0;
  for (std::size_t at = 0; (at = line.find_first_not_of(kSeparators, at)) != line.npos; ++count) {
    at = std::min(line.find_first_of(kSeparators, at), line.size());
  }
  return count;
}

}  // namespace

CountLines find_count_lines(InputBuffer& input) {
  const InputBuffer::Mark start = input.mark();
  input.skip_byte_order_mark();
  CountLines found = CountLines::kNone;
  std::string_view line;
  if (next_scan_line(input, line) && count_in(line)) {
    found = next_scan_line(input, line) && count_in(line) ? CountLines::kTwo : CountLines::kOne;
  }
  input.return_to(start);
  return found;
}

bool next_scan_line(InputBuffer& input, std::string_view& line) {
  do {
    if (!input.next_line(line)) return false;
    while (!line.empty() && is_blank(line.back())) line.remove_suffix(1);
    while (!line.empty() && is_blank(line.front())) line.remove_prefix(1);
  } while (line.empty() || line.front() == '#' || line.starts_with("//"));
  return true;
}

std::optional<std::uint64_t> count_in(std::string_view line) {
  std::uint64_t value = 0;
  const char* const end = line.data() + line.size();
  const auto [stop, error] = std::from_chars(line.data(), end, value);
  if (error != std::errc() || stop != end) return std::nullopt;
  return value;
}

std::uint64_t most_scan_points(const InputBuffer& input) {
  constexpr std::uint64_t kShortest = 6;  // bytes of "0 0 0" and a line break, which may lack
  return (*input.size() - input.position() + 1) / kShortest;
}

bool parse_scan_point(std::string_view line, Vec3& point) {
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

void OpenEnd::look(const InputBuffer& input, std::string_view line) {
  const std::size_t values = count_values(line);
  if (values_ == 0) values_ = values;
  if (input.line_terminated()) return;
  const std::string what = "the file ends without a line break";
  if (values < values_) {
    refuse_line(input.name(), input.line(),
                what + " after " + std::to_string(values) + " of " + std::to_string(values_) +
                    " values, so it is cut; expected all values of the last line");
  }
  if (line.ends_with('.')) {
    refuse_line(input.name(), input.line(), what + " within a number; expected all of it");
  }
  open_ = true;
}

void OpenEnd::append_to(std::vector<Message>& remarks, const std::string& name) const {
  if (!open_) return;
  remarks.push_back(
      {Message::Severity::kNote, "no-line-break", name + ": the file ends without a line break"});
}

}  // namespace clearway
