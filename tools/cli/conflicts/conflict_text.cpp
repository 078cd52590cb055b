#include "cli/conflicts/conflict_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "core/util/format.hpp"

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

std::vector<Conflict> worst_of(const Conflicts& conflicts, std::size_t most) {
  std::vector<Conflict> out = conflicts.listed;
  std::ranges::stable_sort(out, [](const Conflict& a, const Conflict& b) {
    if (a.least_distance.has_value() != b.least_distance.has_value()) {
      return a.least_distance.has_value();
    }
    return a.least_distance.value_or(0) < b.least_distance.value_or(0);
  });
  if (out.size() > most) out.resize(most);
  return out;
}

std::string row_text(const Conflict& c, bool distances, bool depths) {
  std::string row = fmt::format("{:>5}  {:>19}  {:>11}  {:>7}", c.id,
                                fmt::format("{:.2f} - {:.2f}", c.chainage_from, c.chainage_to),
                                format_count(c.points), name_of(c.side));
  if (distances) {
    row += c.least_distance
               ? fmt::format("  {:>12.3f}  {:>16.3f}", *c.least_distance, *c.encroachment)
               : fmt::format("  {:>12}  {:>16}", "-", "-");
  }
  if (depths) {
    row += fmt::format("  {:>9.3f}  {:>11}", c.depth.value_or(0),
                       format_count(c.points_inside.value_or(0)));
  }
  return row + fmt::format("  {:.3f} {:.3f} {:.3f}\n", c.centroid.x, c.centroid.y, c.centroid.z);
}

std::string totals_text(const ConflictFile& file) {
  const Conflicts& c = file.conflicts;
  if (c.colliding_points == 0) return "no conflicts: no point collides\n";
  std::string text = counted(c.listed.size(), "conflict") + " of " +
                     counted(c.colliding_points - c.small_points, "point") + " along " +
                     format_brief(c.path_length) + " " + symbol_of(file.unit()) + " of path\n";
  if (c.small_groups > 0) {
    text += "not listed: " + counted(c.small_groups, "group") + " of fewer than " +
            counted(file.options.min_points, "point") + ", together " +
            counted(c.small_points, "point") + "\n";
  }
  return text;
}

}  // namespace

std::string conflict_text(const ConflictFile& file, std::size_t most) {
  const Conflicts& conflicts = file.conflicts;
  std::string text = totals_text(file);
  if (conflicts.listed.empty() || most == 0) return text;
  const bool distances = has_distances(conflicts), depths = has_depths(conflicts);
  const char* const unit = symbol_of(file.unit());
  const std::vector<Conflict> rows = worst_of(conflicts, most);
  if (rows.size() < conflicts.listed.size()) {
    text += fmt::format("the {} {}:\n", distances ? "worst" : "first", rows.size());
  }
  text += fmt::format("{:>5}  {:>19}  {:>11}  {:>7}", "id", fmt::format("chainage ({})", unit),
                      "points", "side");
  if (distances) {
    text += fmt::format("  {:>12}  {:>16}", fmt::format("distance ({})", unit),
                        fmt::format("encroachment ({})", unit));
  }
  if (depths) text += fmt::format("  {:>9}  {:>11}", fmt::format("depth ({})", unit), "inside");
  text += "  centroid\n";
  for (const Conflict& conflict : rows) text += row_text(conflict, distances, depths);
  return text;
}

}  // namespace clearway::tool
