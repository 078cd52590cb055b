#include "cli/conflicts/conflict_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "core/util/format.hpp"
#include "findings/conflict_rank.hpp"
#include "io/conflicts/conflict_fields.hpp"

namespace clearway::tool {
namespace {

bool has_distances(const Conflicts& conflicts) {
  return std::ranges::any_of(conflicts.listed,
                             [](const Conflict& c) { return c.least_distance.has_value(); });
}

bool has_depths(const Conflicts& conflicts) {
  return std::ranges::any_of(conflicts.listed,
                             [](const Conflict& c) { return c.points_inside.value_or(0) > 0; });
}

/// The worst conflicts, at most `most`: by least distance, or along the path where distances are
/// not known.
std::vector<Conflict> worst_of(const Conflicts& conflicts, std::size_t most) {
  std::vector<Conflict> out = conflicts.listed;
  const bool shifts = has_shifts(conflicts);
  if (has_distances(conflicts)) {
    std::ranges::stable_sort(
        out, [&](const Conflict& a, const Conflict& b) { return is_worse(a, b, shifts); });
  }
  if (out.size() > most) out.resize(most);
  return out;
}

std::string length_cell(const std::optional<double>& length, int width, int digits) {
  return length ? fmt::format("  {:>{}.{}f}", *length, width, digits)
                : fmt::format("  {:>{}}", "-", width);
}

std::string row_text(const Conflict& c, bool distances, bool depths, bool shifts) {
  std::string row = fmt::format("{:>5}  {:>19}", c.id,
                                fmt::format("{:.2f} - {:.2f}", c.chainage_from, c.chainage_to)) +
                    length_cell(c.obstacle_chainage, 12, 2) +
                    fmt::format("  {:>11}  {:>7}", format_count(c.points), name_of(c.side));
  if (distances) {
    row += c.least_distance
               ? fmt::format("  {:>12.3f}  {:>16.3f}", *c.least_distance, *c.encroachment)
               : fmt::format("  {:>12}  {:>16}", "-", "-");
  }
  if (depths) {
    row += fmt::format("  {:>9.3f}  {:>11}", c.depth.value_or(0),
                       format_count(c.points_inside.value_or(0)));
  }
  if (shifts)
    row += length_cell(rounded_up(c.shift_left), 14, 3) +
           length_cell(rounded_up(c.shift_right), 15, 3);
  return row + fmt::format("  {:.3f} {:.3f} {:.3f}\n", c.centroid.x, c.centroid.y, c.centroid.z);
}

/// A line about the groups that are not listed, and where the first of them is.
std::string small_text(const ConflictFile& file) {
  const Conflicts& c = file.conflicts;
  if (c.small_groups == 0) return "";
  const SmallGroup& first = c.small.front();
  return (c.listed.empty() ? "" : "not listed: ") + counted(c.small_groups, "group") +
         " of fewer than " + counted(file.options.min_points, "point") + ", together " +
         counted(c.small_points, "point") + "; " +
         (c.small_groups == 1 ? "it is" : "the first is") +
         fmt::format(
             " at chainage {:.2f} - {:.2f}, {:.3f} {:.3f} {:.3f}. --min-points 1 lists {}\n",
             first.chainage_from, first.chainage_to, (first.box.lo.x + first.box.hi.x) / 2,
             (first.box.lo.y + first.box.hi.y) / 2, (first.box.lo.z + first.box.hi.z) / 2,
             c.small_groups == 1 ? "it" : "them");
}

std::string totals_text(const ConflictFile& file) {
  const Conflicts& c = file.conflicts;
  if (c.colliding_points == 0) return "no conflicts, because no point collides\n";
  const std::string path =
      " along " + format_brief(c.path_length) + " " + symbol_of(file.unit()) + " of path\n";
  if (c.listed.empty()) {
    return counted(c.small_points, "point") + (c.small_points == 1 ? " collides" : " collide") +
           path + "no conflict is listed, for every group is small: " + small_text(file);
  }
  return counted(c.listed.size(), "conflict") + " of " +
         counted(c.colliding_points - c.small_points, "point") + path + small_text(file);
}

}  // namespace

std::string conflict_text(const ConflictFile& file, std::size_t most) {
  const Conflicts& conflicts = file.conflicts;
  std::string text = totals_text(file);
  if (conflicts.listed.empty() || most == 0) return text;
  const bool distances = has_distances(conflicts), depths = has_depths(conflicts);
  const bool shifts = has_shifts(conflicts);
  const char* const unit = symbol_of(file.unit());
  const std::vector<Conflict> rows = worst_of(conflicts, most);
  if (rows.size() < conflicts.listed.size()) {
    text += fmt::format("the {} {}:\n", distances ? "worst" : "first", rows.size());
  }
  text +=
      fmt::format("{:>5}  {:>19}  {:>12}  {:>11}  {:>7}", "id", fmt::format("chainage ({})", unit),
                  fmt::format("obstacle ({})", unit), "points", "side");
  if (distances) {
    text += fmt::format("  {:>12}  {:>16}", fmt::format("distance ({})", unit),
                        fmt::format("encroachment ({})", unit));
  }
  if (depths) text += fmt::format("  {:>9}  {:>11}", fmt::format("depth ({})", unit), "inside");
  if (shifts) {
    text += fmt::format("  {:>14}  {:>15}", fmt::format("shift left ({})", unit),
                        fmt::format("shift right ({})", unit));
  }
  text += "  centroid\n";
  for (const Conflict& conflict : rows) text += row_text(conflict, distances, depths, shifts);
  if (!conflicts.has_last_poses) {
    text +=
        "chainages end where a point is touched for the first time, because this result has no "
        "last poses; run the search again to see where the touch ends\n";
  }
  return text;
}

}  // namespace clearway::tool
