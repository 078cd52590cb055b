#include "io/formats/ptx/scan_lines.hpp"

#include <charconv>

#include "io/formats/text/text_number.hpp"

namespace clearway {

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

bool parse_scan_point(std::string_view line, Vec3& point, bool& more) {
  const char* at = line.data();
  const char* const end = at + line.size();
  char first = 0;
  if (!parse_number(at, end, point.x) || (first = skip_separator(at, end)) == 0 ||
      !parse_number(at, end, point.y) || skip_separator(at, end) != first ||
      !parse_number(at, end, point.z)) {
    return false;
  }
  more = at != end;
  if (!more) return true;
  const char behind = skip_separator(at, end);
  return behind == first || behind == ' ';
}

Message last_number_may_be_cut(const std::string& name, std::uint64_t line) {
  return {Message::Severity::kWarning,
          "last-number-may-be-cut",
          name + ": line " + std::to_string(line) +
              ", the last, ends without a line break: its z may lack digits. Add a line break if "
              "the file is complete",
          {{"line", static_cast<double>(line)}}};
}

}  // namespace clearway
