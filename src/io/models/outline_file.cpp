#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "clearway/outline.hpp"
#include "core/messages/messages.hpp"
#include "core/util/format.hpp"
#include "io/files/input_error.hpp"
#include "io/files/text_number.hpp"
#include "io/scans/input_buffer.hpp"
#include "io/scans/text/point_blocks.hpp"

namespace clearway {
namespace {

/// Two numbers of a line, and the line's number in the file.
struct Row {
  double first, second;
  std::uint64_t line;
};

/// The names in a line of names, in small letters and without blanks.
std::string names_in(std::string_view line) {
  std::string names;
  for (const char c : line) {
    if (is_blank(c) || c == '"') continue;
    names += c == ';' ? ',' : static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  }
  return names;
}

void check_names(const InputBuffer& input, std::string_view line, bool mirror) {
  const std::string names = names_in(line);
  if (names == (mirror ? "height,half_width" : "y,z")) return;
  std::string expected = mirror ? "two numbers, or first the names height,half_width"
                                : "two numbers, or first the names y,z";
  if (names == "height,half_width")
    expected += "; one half of a symmetric outline is to be mirrored with --mirror";
  if (names == "y,z") expected += "; a whole outline is not to be mirrored";
  refuse_line(input.name(), input.line(),
              excerpt(line) + decimal_commas_in(line) + "; expected " + expected);
}

std::vector<Row> rows_of(const std::filesystem::path& path, bool mirror) {
  InputBuffer input(File::open_regular(path), InputBuffer::Access::kSeek);
  input.begin_text();
  std::vector<Row> rows;
  std::string_view line;
  bool first = true;
  while (input.next_line(line)) {
    if (line.find_first_not_of(" \t") == std::string_view::npos) continue;
    double numbers[2];
    const auto count = parse_number_line(line, numbers);
    if (!count && std::exchange(first, false)) {
      check_names(input, line, mirror);
      continue;
    }
    first = false;
    if (count != std::size_t{2} || !std::isfinite(numbers[0]) || !std::isfinite(numbers[1])) {
      refuse_line(input.name(), input.line(),
                  excerpt(line) + decimal_commas_in(line) + "; expected two finite numbers");
    }
    if (mirror && numbers[1] < 0) {
      refuse_line(input.name(), input.line(),
                  excerpt(line) + "; expected half a width of 0 or more after the height");
    }
    if (rows.size() == kMostOutlinePoints) {
      refuse_line(input.name(), input.line(),
                  "has more corners than " + format_count(kMostOutlinePoints));
    }
    rows.push_back({numbers[0], numbers[1], input.line()});
  }
  if (rows.empty()) refuse(input.name(), "holds no corner of an outline; expected three at least");
  return rows;
}

/// Whether the outline lies on one side of the vehicle's middle and has an edge on it, as one half
/// of a symmetric outline has.
bool is_half(std::span<const OutlinePoint> outline) {
  const bool left = std::ranges::all_of(outline, [](const OutlinePoint& p) { return p.y >= 0; });
  const bool right = std::ranges::all_of(outline, [](const OutlinePoint& p) { return p.y <= 0; });
  if (left == right) return false;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const OutlinePoint &a = outline[i], &b = outline[(i + 1) % outline.size()];
    if (a.y == 0 && b.y == 0 && a.z != b.z) return true;
  }
  return false;
}

}  // namespace

std::vector<OutlinePoint> read_outline(const std::filesystem::path& path,
                                       const OutlineOptions& options,
                                       std::vector<Message>* messages) {
  const std::vector<Row> rows = rows_of(path, options.mirror);
  const double environment = options.environment_unit;
  const UnitFactor lengths(
      options.unit.is_known() ? options.unit.metres_in(environment) : environment, environment);
  std::vector<OutlinePoint> outline;
  for (const Row& row : rows) {
    const OutlinePoint point =
        options.mirror ? OutlinePoint{row.second, row.first} : OutlinePoint{row.first, row.second};
    outline.push_back({lengths(point.y), lengths(point.z)});
  }
  if (options.mirror) {
    for (std::size_t i = outline.size(); i-- > 0;) {
      if (outline[i].y != 0) outline.push_back({-outline[i].y, outline[i].z});
    }
  }
  if (outline.size() > 1 && outline.front() == outline.back()) outline.pop_back();
  if (messages != nullptr && !options.mirror && is_half(outline)) {
    messages->push_back(warning(
        "half-outline",
        path.string() +
            ": all corners are on one side of the middle, y = 0, and an edge runs along it, as in "
            "one half of a symmetric outline. The other side is taken to be free"));
  }
  return outline;
}

}  // namespace clearway
