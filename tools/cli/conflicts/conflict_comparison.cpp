#include "cli/conflicts/conflict_comparison.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "clearway/error.hpp"
#include "cli/conflicts/conflict_comparison_files.hpp"
#include "cli/support/console.hpp"
#include "cli/support/option_groups.hpp"
#include "cli/support/options.hpp"
#include "cli/support/signals.hpp"
#include "cli/support/standard_output.hpp"
#include "cli/support/trajectory_options.hpp"
#include "cli/vehicle/vehicle_inputs.hpp"
#include "cli/verdict.hpp"
#include "core/util/format.hpp"
#include "findings/known_places.hpp"
#include "io/formats/wkt.hpp"
#include "io/result/result.hpp"
#include "io/system/pending_file.hpp"

namespace clearway::tool {
namespace {

/// One of the two results that are compared.
struct ComparedSide {
  ComparedSide(ConflictComparison& options, const std::filesystem::path& file,
               const std::filesystem::path& trajectory, const std::filesystem::path& vehicle)
      : result(file) {
    check_kind_of_model(result, {}, vehicle);
    warn_of_doubts(result.reader());
    const std::vector<Pose> poses = read_poses(trajectory, options.trajectory_options, result);
    std::vector<Body> bodies;
    if (!vehicle.empty()) {
      std::vector<Message> told;
      bodies = read_bodies_of(vehicle, options.model_options, options, poses, result, told);
      for (const Message& message : told) {
        if (message.severity == Message::Severity::kWarning) log_message(message);
      }
    }
    ConflictOptions find = options.find;
    find.bodies = bodies;
    conflicts = find_conflicts(result, poses, find, &conflict_of);
  }

  ComparedResult compared() {
    return {result.reader().name(), result.parameters().radius,
            symbol_of(units_of_wkt(result.reader().header().crs_wkt).horizontal),
            std::move(conflicts)};
  }
  GroupedResult grouped() const { return {result, conflicts, conflict_of}; }

  Result result;
  Conflicts conflicts;
  std::vector<std::uint32_t> conflict_of;
};

/// The pairs of the same conflict in which b comes nearer, or deeper, by more than `worse_by`.
std::vector<std::pair<std::uint32_t, std::uint32_t>> worse_ones(const ComparedConflicts& found) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> out;
  for (const auto& pair : found.match.same) {
    const auto in_a = conflict_at(found.a.conflicts, pair.first).least_distance;
    const auto in_b = conflict_at(found.b.conflicts, pair.second).least_distance;
    if (in_b && (!in_a || *in_b < *in_a - found.worse_by)) out.push_back(pair);
  }
  return out;
}

std::string line_of(const Conflict& c) {
  return fmt::format("  {:>5}  {:>19}  {:>11} {:<6}  {:>7}  {:.3f} {:.3f} {:.3f}\n", c.id,
                     fmt::format("{:.2f} - {:.2f}", c.chainage_from, c.chainage_to),
                     format_count(c.points), c.points == 1 ? "point" : "points", name_of(c.side),
                     c.centroid.x, c.centroid.y, c.centroid.z);
}

/// A title with a number, and the lines of at most `show` items.
template <typename Items, typename Line>
std::string list_text(const std::string& title, const Items& items, std::uint64_t show, Line line) {
  std::string text = title + ": " + format_count(items.size()) + "\n";
  std::uint64_t shown = 0;
  for (const auto& item : items) {
    if (shown++ == show) break;
    text += line(item);
  }
  if (items.size() > show) text += "  and " + format_count(items.size() - show) + " more\n";
  return text;
}

std::string side_text(const char* name, const ComparedResult& side) {
  const Conflicts& found = side.conflicts;
  std::string text =
      fmt::format("{}: {} of {} in {}\n", name, counted(found.listed.size(), "conflict"),
                  counted(found.colliding_points - found.small_points, "point"), side.file);
  if (found.small_groups > 0) {
    text += fmt::format("{}: {} of {} {} too small to be listed\n", name,
                        counted(found.small_groups, "group"), counted(found.small_points, "point"),
                        found.small_groups == 1 ? "is" : "are");
  }
  return text;
}

std::string text_of(const ComparedConflicts& found, std::uint64_t show) {
  const Conflicts &a = found.a.conflicts, &b = found.b.conflicts;
  std::string text = side_text("a", found.a) + side_text("b", found.b);
  for (const QueryDifference& query : found.questions) {
    text += "queries differ: " + query.what + ": " + query.a + " / " + query.b + "\n";
  }
  const auto of_b = [&](std::uint32_t id) { return line_of(conflict_at(b, id)); };
  text += list_text("new, only in b", found.match.added, show, of_b);
  if (!found.new_small.empty()) {
    text += list_text(
        "new groups that are too small to be listed", found.new_small, show, [&](std::size_t i) {
          const SmallGroup& group = b.small[i];
          return fmt::format("  {:>5}  {:>19}  {:>11} {:<6}  {:.3f} {:.3f} {:.3f}\n", "",
                             fmt::format("{:.2f} - {:.2f}", group.chainage_from, group.chainage_to),
                             format_count(group.points), group.points == 1 ? "point" : "points",
                             group.box.lo.x, group.box.lo.y, group.box.lo.z);
        });
  }
  if (found.distances_known) {
    text += list_text(
        "worse by more than " + format_brief(found.worse_by) + " " + found.a.unit, found.worse,
        show, [&](const auto& pair) {
          const auto before = conflict_at(a, pair.first).least_distance;
          std::string line = of_b(pair.second);
          line.pop_back();
          return line + fmt::format("  {} -> {:.3f} {}\n",
                                    before ? fmt::format("{:.3f}", *before) : "unknown",
                                    *conflict_at(b, pair.second).least_distance, found.a.unit);
        });
  } else {
    text += "worse: not known, because the results have no clearances (run --clearance)\n";
  }
  text += list_text("gone, only in a", found.match.gone, show,
                    [&](std::uint32_t id) { return line_of(conflict_at(a, id)); });
  text += "the same in both: " + format_count(found.match.same.size()) + "\n";
  return text + sentence_of(found) + "\n";
}

}  // namespace

void add_conflict_comparison(CLI::App& command, ConflictComparison& options,
                             CLI::Option* conflicts) {
  const std::vector<CLI::Option*> before = command.get_options();
  const GroupScope inputs(command, OptionGroup::kInputs);
  command.add_option("--trajectory", options.trajectory, "The trajectory of A, and of B")
      ->type_name("FILE");
  command
      .add_option("--trajectory-b", options.trajectory_b,
                  "The trajectory of B, where it is another")
      ->type_name("FILE");
  command
      .add_option("--vehicle", options.vehicle,
                  "The vehicle of several bodies of A, and of B: for sides")
      ->type_name("FILE");
  command.add_option("--vehicle-b", options.vehicle_b, "The vehicle of B, where it is another")
      ->type_name("FILE");
  add_conflict_options(command, options);
  {
    const GroupScope conflict_group(command, OptionGroup::kConflicts);
    options.lengths.add(
        command, "--worse-by", options.worse_by,
        "A conflict is worse where it comes nearer, or reaches deeper, by more than "
        "this (default: 0.02)",
        LengthRange::kFromZero);
    command.add_flag("--allow-other-question", options.allow_other_question,
                     "Compare results of different questions; they differ otherwise (exit code 1)");
  }
  command
      .add_option("-o,--output", options.output,
                  "Write the comparison to a file: .csv, .json or .html")
      ->type_name("FILE");
  const GroupScope files(command, OptionGroup::kFiles);
  command.add_flag("--force", options.force, "Overwrite an existing output");
  for (CLI::Option* option : command.get_options()) {
    if (std::ranges::find(before, option) == before.end()) option->needs(conflicts);
  }
}

bool compare_conflicts(ConflictComparison& options, const std::filesystem::path& a,
                       const std::filesystem::path& b, std::uint64_t show, bool json) {
  if (options.trajectory.empty()) {
    throw UsageError("--conflicts needs --trajectory, the trajectory of the runs");
  }
  const auto or_a = [](const std::filesystem::path& of_b, const std::filesystem::path& of_a) {
    return of_b.empty() ? of_a : of_b;
  };
  const std::filesystem::path path_b = or_a(options.trajectory_b, options.trajectory);
  const std::filesystem::path vehicle_b = or_a(options.vehicle_b, options.vehicle);
  std::optional<PendingFile> output;
  if (!options.output.empty()) {
    check_comparison_ending(options.output);
    refuse_overwriting(options.output,
                       {a, b, options.trajectory, path_b, options.vehicle, vehicle_b});
    output.emplace(options.output, options.force);
  }
  const double unit = options.lengths.convert_for(a.string(), Result(a).reader().header().crs_wkt);
  options.trajectory_options.environment_unit = unit;
  options.model_options.environment_unit = unit;
  ConsoleProgress progress;
  options.find.progress = [&progress](const ProgressUpdate& update) { progress.update(update); };
  options.find.stop = &stop_flag();
  ComparedSide in_a(options, a, options.trajectory, options.vehicle);
  ComparedSide in_b(options, b, path_b, vehicle_b);
  ComparedConflicts found;
  const ResultHeader &header_a = in_a.result.reader().header(),
                     &header_b = in_b.result.reader().header();
  found.questions = question_differences(header_a, header_b);
  found.other_question_allowed = options.allow_other_question;
  found.distances_known = header_a.clearance > 0 && header_b.clearance > 0;
  found.worse_by = options.worse_by;
  found.match = match_conflicts(in_a.conflicts, in_b.conflicts, options.find.gap);
  found.new_small = match_points(in_a.grouped(), in_b.grouped(), options.find.gap, found.match);
  found.a = in_a.compared();
  found.b = in_b.compared();
  if (found.a.unit != found.b.unit) {
    throw InputError(found.b.file + ": its coordinates are in " + found.b.unit + ", expected " +
                     found.a.unit + " as in " + found.a.file);
  }
  if (found.distances_known) found.worse = worse_ones(found);
  if (output) {
    write_comparison(found, options.output, output->partial());
    output->publish();
  }
  print(json ? json_of(found) : text_of(found, show));
  return found.holds();
}

}  // namespace clearway::tool
