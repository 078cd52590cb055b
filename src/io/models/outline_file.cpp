#include <algorithm>
#include <array>
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
#include "io/scans/text/point_blocks.hpp"
#include "io/scans/text/text_table.hpp"

namespace clearway {
namespace {

void check_names(TextTable& table, bool mirror) {
  constexpr std::string_view kWhole[] = {"y", "z"}, kHalf[] = {"height", "half_width"};
  const bool whole = table.is_header(kWhole), half = table.is_header(kHalf);
  if (mirror ? half : whole) return;
  std::string expected = mirror ? "two numbers, or first the names height,half_width"
                                : "two numbers, or first the names y,z";
  if (half) expected += "; one half of a symmetric outline is to be mirrored with --mirror";
  if (whole) expected += "; a whole outline is not to be mirrored";
  table.refuse_here(excerpt(table.line()) + decimal_commas_in(table.line()) + "; expected " +
                    expected);
}

/// The corners in a file as it has them, y first.
std::vector<OutlinePoint> corners_in(const std::filesystem::path& path, bool mirror) {
  TextTable table(InputBuffer::open_regular(path));
  std::vector<OutlinePoint> corners;
  for (bool first = true; table.next(); first = false) {
    std::array<double, 2> numbers{};
    const auto count = parse_number_line(table.line(), numbers);
    if (!count && first) {
      check_names(table, mirror);
      continue;
    }
    if (count != numbers.size() || !std::isfinite(numbers[0]) || !std::isfinite(numbers[1])) {
      table.refuse_here(excerpt(table.line()) + decimal_commas_in(table.line()) +
                        "; expected two finite numbers");
    }
    if (mirror && numbers[1] < 0) {
      table.refuse_here(excerpt(table.line()) +
                        "; expected half a width of 0 or more after the height");
    }
    if (corners.size() == kMostOutlinePoints) {
      table.refuse_here("has more corners than " + format_count(kMostOutlinePoints));
    }
    if (mirror) std::swap(numbers[0], numbers[1]);
    corners.push_back({numbers[0], numbers[1]});
  }
  if (corners.empty()) {
    refuse(table.name(), "holds no corner of an outline; expected three at least");
  }
  return corners;
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
  const double environment = options.environment_unit;
  const UnitFactor lengths(
      options.unit.is_known() ? options.unit.metres_in(environment) : environment, environment);
  std::vector<OutlinePoint> outline = corners_in(path, options.mirror);
  for (OutlinePoint& point : outline) point = {lengths(point.y), lengths(point.z)};
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
