#include "cli/conflicts/conflict_comparison.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "clearway/error.hpp"
#include "cli/support/console.hpp"
#include "cli/support/signals.hpp"
#include "cli/support/standard_output.hpp"
#include "cli/support/trajectory_options.hpp"
#include "core/util/format.hpp"
#include "findings/match_conflicts.hpp"
#include "io/formats/wkt.hpp"
#include "io/result/result.hpp"

namespace clearway::tool {
namespace {

using nlohmann::ordered_json;

/// A result and its conflicts.
struct Compared {
  std::string file;
  double radius;
  std::string unit;
  Conflicts conflicts;
};

Compared find_side(ConflictComparison& options, const std::filesystem::path& file,
                   const std::filesystem::path& trajectory) {
  const Result result(file);
  const std::vector<Pose> poses = read_poses(trajectory, options.trajectory_options, result);
  return {file.string(), result.parameters().radius,
          symbol_of(units_of_wkt(result.reader().header().crs_wkt).horizontal),
          find_conflicts(result, poses, options.find)};
}

const Conflict& conflict_at(const Conflicts& conflicts, std::uint32_t id) {
  return conflicts.listed[id - 1];
}

std::string line_of(const Conflict& c) {
  return fmt::format("  {:>5}  {:>19}  {:>11} {:<6}  {:>7}  {:.3f} {:.3f} {:.3f}\n", c.id,
                     fmt::format("{:.2f} - {:.2f}", c.chainage_from, c.chainage_to),
                     format_count(c.points), c.points == 1 ? "point" : "points", name_of(c.side),
                     c.centroid.x, c.centroid.y, c.centroid.z);
}

std::string list_text(const char* title, const Conflicts& conflicts,
                      const std::vector<std::uint32_t>& ids, std::size_t show) {
  std::string text = std::string(title) + ": " + format_count(ids.size()) + "\n";
  for (std::size_t i = 0; i < std::min(show, ids.size()); ++i) {
    text += line_of(conflict_at(conflicts, ids[i]));
  }
  if (ids.size() > show) text += "  and " + format_count(ids.size() - show) + " more\n";
  return text;
}

/// Points that collide and are in no conflict: there may be new ones among them.
bool has_more_small_points(const Compared& a, const Compared& b) {
  return b.conflicts.small_points > a.conflicts.small_points;
}

std::string text_of(const Compared& a, const Compared& b, const ConflictMatch& match,
                    std::size_t show) {
  std::string text;
  for (const auto& [name, side] : {std::pair("a", &a), std::pair("b", &b)}) {
    const Conflicts& found = side->conflicts;
    text += fmt::format("{}: {} of {} in {}\n", name, counted(found.listed.size(), "conflict"),
                        counted(found.colliding_points - found.small_points, "point"), side->file);
    if (found.small_groups > 0) {
      text += fmt::format(
          "{}: {} of {} {} too small to be compared\n", name, counted(found.small_groups, "group"),
          counted(found.small_points, "point"), found.small_groups == 1 ? "is" : "are");
    }
  }
  if (a.radius != b.radius) {
    text += "queries differ: radius: " + format_number(a.radius) + " / " + format_number(b.radius) +
            " " + a.unit + "\n";
  }
  text += list_text("new, only in b", b.conflicts, match.added, show);
  text += list_text("gone, only in a", a.conflicts, match.gone, show);
  text += "the same in both: " + format_count(match.same.size()) + "\n";
  if (!match.added.empty()) return text + "new conflicts\n";
  return text + (has_more_small_points(a, b)
                     ? "no new conflicts, but b has more points in groups that are too small\n"
                     : "no new conflicts\n");
}

ordered_json json_of_conflict(const Conflict& c) {
  ordered_json out{{"id", c.id},
                   {"points", c.points},
                   {"source", c.source},
                   {"lo", {c.box.lo.x, c.box.lo.y, c.box.lo.z}},
                   {"hi", {c.box.hi.x, c.box.hi.y, c.box.hi.z}},
                   {"centroid", {c.centroid.x, c.centroid.y, c.centroid.z}},
                   {"chainage_from", c.chainage_from},
                   {"chainage_to", c.chainage_to},
                   {"least_distance", nullptr},
                   {"side", name_of(c.side)}};
  if (c.least_distance) out["least_distance"] = *c.least_distance;
  return out;
}

ordered_json json_of_list(const Conflicts& conflicts, const std::vector<std::uint32_t>& ids) {
  auto out = ordered_json::array();
  for (const std::uint32_t id : ids) out.push_back(json_of_conflict(conflict_at(conflicts, id)));
  return out;
}

std::string json_of(const Compared& a, const Compared& b, const ConflictMatch& match) {
  const auto side = [](const Compared& of) {
    return ordered_json{{"file", of.file},
                        {"unit", of.unit},
                        {"radius", of.radius},
                        {"conflicts", of.conflicts.listed.size()},
                        {"colliding_points", of.conflicts.colliding_points},
                        {"small_groups", of.conflicts.small_groups},
                        {"small_points", of.conflicts.small_points}};
  };
  auto same = ordered_json::array();
  for (const auto& [in_a, in_b] : match.same) {
    same.push_back({{"a", json_of_conflict(conflict_at(a.conflicts, in_a))},
                    {"b", json_of_conflict(conflict_at(b.conflicts, in_b))}});
  }
  const ordered_json out{{"a", side(a)},
                         {"b", side(b)},
                         {"new", json_of_list(b.conflicts, match.added)},
                         {"gone", json_of_list(a.conflicts, match.gone)},
                         {"same", same}};
  // Names of files need not be UTF-8.
  return out.dump(-1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace

void add_conflict_comparison(CLI::App& command, ConflictComparison& options,
                             CLI::Option* conflicts) {
  const std::vector<CLI::Option*> before = command.get_options();
  command.add_option("--trajectory", options.trajectory, "The trajectory of A, and of B")
      ->type_name("FILE");
  command
      .add_option("--trajectory-b", options.trajectory_b,
                  "The trajectory of B, where it is another")
      ->type_name("FILE");
  add_conflict_options(command, options);
  for (CLI::Option* option : command.get_options()) {
    if (std::ranges::find(before, option) == before.end()) option->needs(conflicts);
  }
}

bool compare_conflicts(ConflictComparison& options, const std::filesystem::path& a,
                       const std::filesystem::path& b, std::size_t show, bool json) {
  if (options.trajectory.empty()) {
    throw UsageError("--conflicts needs --trajectory, the trajectory of the runs");
  }
  options.trajectory_options.environment_unit =
      options.lengths.convert_for(a.string(), Result(a).reader().header().crs_wkt);
  ConsoleProgress progress;
  options.find.progress = [&progress](const ProgressUpdate& update) { progress.update(update); };
  options.find.stop = &stop_flag();
  const Compared in_a = find_side(options, a, options.trajectory);
  const Compared in_b = find_side(
      options, b, options.trajectory_b.empty() ? options.trajectory : options.trajectory_b);
  if (in_a.unit != in_b.unit) {
    throw InputError(in_b.file + ": its coordinates are in " + in_b.unit + ", expected " +
                     in_a.unit + " as in " + in_a.file);
  }
  const ConflictMatch match = match_conflicts(in_a.conflicts, in_b.conflicts, options.find.gap);
  print(json ? json_of(in_a, in_b, match) : text_of(in_a, in_b, match, show));
  return match.added.empty() && !has_more_small_points(in_a, in_b);
}

}  // namespace clearway::tool
