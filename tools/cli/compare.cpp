#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "cli/commands.hpp"
#include "cli/conflicts/conflict_comparison.hpp"
#include "cli/run_again.hpp"
#include "cli/support/console.hpp"
#include "cli/support/options.hpp"
#include "cli/support/program.hpp"
#include "cli/verdict.hpp"
#include "core/util/format.hpp"
#include "io/files/json.hpp"
#include "io/result/check_results.hpp"

namespace clearway::tool {
namespace {

const char* kind_text(PointDifference::Kind kind) {
  constexpr const char* kNames[]{"only in a", "only in b", "first pose",
                                 "last pose", "depth",     "coordinates"};
  return kNames[static_cast<std::size_t>(kind)];
}

/// "0.25 to 17", with the index of the free point.
std::string depth_text(double depth, std::uint64_t source) {
  if (source == Collisions::kNoPoint) return "nothing free";
  return format_number(depth) + " to " + std::to_string(source);
}

std::string point_text(const PointDifference& point) {
  using Kind = PointDifference::Kind;
  std::string text = fmt::format("  {}  {} ", kind_text(point.kind), point.source);
  for (int k = 0; k < 3; ++k) text += " " + format_number(point.xyz[k]);
  if (point.kind == Kind::kFirstPose) {
    text += fmt::format("  pose {} / {}", *point.first_pose_a, *point.first_pose_b);
  } else if (point.kind == Kind::kLastPose) {
    text += fmt::format("  pose {} / {}", *point.last_pose_a, *point.last_pose_b);
  } else if (point.kind == Kind::kDepth) {
    text += "  " + depth_text(*point.depth_a, *point.depth_source_a) + " / " +
            depth_text(*point.depth_b, *point.depth_source_b);
  }
  return text + "\n";
}

std::uint64_t all_differences(const Comparison& c) {
  return c.only_in_a + c.only_in_b + c.differing_coordinates + c.differing_first_poses.value_or(0) +
         c.differing_last_poses.value_or(0) + c.differing_depths.value_or(0);
}

/// Adds a member where there is a value.
template <typename Value>
void add(const char* key, const std::optional<Value>& value, Json& out) {
  if (value) out[key] = *value;
}

Json point_json(const PointDifference& point) {
  Json out{{"kind", kind_text(point.kind)}, {"source", point.source}, {"xyz", point.xyz}};
  add("first_pose_a", point.first_pose_a, out);
  add("first_pose_b", point.first_pose_b, out);
  add("last_pose_a", point.last_pose_a, out);
  add("last_pose_b", point.last_pose_b, out);
  const auto add_depth = [&](const char* depth_key, const auto& depth, const char* source_key,
                             const auto& source) {
    if (!source) return;
    const bool is_free = *source != Collisions::kNoPoint;
    out[depth_key] = is_free ? Json(*depth) : Json();
    out[source_key] = is_free ? Json(*source) : Json();
  };
  add_depth("depth_a", point.depth_a, "depth_source_a", point.depth_source_a);
  add_depth("depth_b", point.depth_b, "depth_source_b", point.depth_source_b);
  return out;
}

Json table_json(const TableComparison& table) {
  return {{"in_a", table.in_a},           {"in_b", table.in_b},
          {"common", table.common},       {"only_in_a", table.only_in_a},
          {"only_in_b", table.only_in_b}, {"differing", table.differing}};
}

/// A comparison in words, in many lines. a, b: the names of the compared files.
std::string comparison_text(const Comparison& c, const std::string& a, const std::string& b) {
  std::string text = fmt::format("a: {} in {}\nb: {} in {}\n", counted(c.in_a, "colliding point"),
                                 a, counted(c.in_b, "colliding point"), b);
  const std::optional<std::uint64_t> coordinates(c.differing_coordinates);
  using Count = std::pair<const char*, std::optional<std::uint64_t>>;
  for (const auto& [words, count] :
       {Count{"in both", c.common}, Count{"only in a", c.only_in_a},
        Count{"only in b", c.only_in_b}, Count{"differing first poses", c.differing_first_poses},
        Count{"differing last poses", c.differing_last_poses},
        Count{"differing depths", c.differing_depths},
        Count{"differing coordinates", *coordinates > 0 ? coordinates : std::nullopt}}) {
    if (count) text += std::string(words) + ": " + format_count(*count) + "\n";
  }
  using Table = std::pair<const char*, std::optional<TableComparison>>;
  for (const auto& [words, table] :
       {Table{"near points", c.near}, Table{"clearances", c.clearances}}) {
    if (!table) continue;
    text += fmt::format("{} in both: {}, only in a: {}, only in b: {}, differing: {}\n", words,
                        format_count(table->common), format_count(table->only_in_a),
                        format_count(table->only_in_b), format_count(table->differing));
  }
  if (c.profiles) {
    text += "differing poses of the profile: " + format_count(c.profiles->differing);
    if (c.profiles->first) text += ", the first is pose " + std::to_string(*c.profiles->first);
    text += "\n";
  }
  for (const QueryDifference& query : c.queries) {
    text += "queries differ: " + query.what + ": " + query.a + " / " + query.b + "\n";
  }
  if (!c.points.empty()) {
    text += "first " + format_count(c.points.size()) + " of " + format_count(all_differences(c)) +
            " differences, with source index and x y z:\n";
    for (const PointDifference& point : c.points) text += point_text(point);
  }
  return text + (c.equal() ? "equal\n" : "different\n");
}

/// A comparison as one JSON object, on one line. a, b: the names of the compared files.
std::string comparison_json(const Comparison& c, const std::string& a, const std::string& b) {
  Json out{{"equal", c.equal()},
           {"a", {{"file", a}, {"colliding_points", c.in_a}}},
           {"b", {{"file", b}, {"colliding_points", c.in_b}}},
           {"common", c.common},
           {"only_in_a", c.only_in_a},
           {"only_in_b", c.only_in_b},
           {"differing_coordinates", c.differing_coordinates},
           {"differing_first_poses", or_null(c.differing_first_poses)}};
  add("differing_last_poses", c.differing_last_poses, out);
  add("differing_depths", c.differing_depths, out);
  out["clearances"] = c.clearances ? table_json(*c.clearances) : Json();
  if (c.near) out["near"] = table_json(*c.near);
  out["profiles"] = nullptr;
  if (c.profiles) {
    out["profiles"] = {{"poses", c.profiles->poses},
                       {"differing", c.profiles->differing},
                       {"first_differing_pose", or_null(c.profiles->first)}};
  }
  out["question_differences"] = questions_json(c.queries);
  out["differences"] = Json::array();
  for (const PointDifference& point : c.points) out["differences"].push_back(point_json(point));
  // File names need not be UTF-8.
  return indented_text(out, -1);
}

/// Returns the exit code.
int run_compare(ConflictComparison& options) {
  if (options.conflicts) {
    int code = kDone;
    run_stoppable(options.b.result, kStartsAgain, [&] { code = compare_conflicts(options); });
    return code;
  }
  const ResultReader a(options.result), b(options.b.result);
  repeat_warnings(a, a.name() + ": ");
  repeat_warnings(b, b.name() + ": ");
  const Comparison comparison = compare_results(a, b, options.show);
  print(options.json ? comparison_json(comparison, a.name(), b.name())
                     : comparison_text(comparison, a.name(), b.name()));
  return comparison.equal() ? kDone : kDiffers;
}

}  // namespace

void add_compare(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<ConflictComparison>();
  options->show = 10;
  CLI::App* command =
      program.add_subcommand("compare", "Say how the colliding points of two results differ");
  add_file(*command, "A", options->result, "Result of clearway run")->required();
  add_file(*command, "B", options->b.result, "Another result about the same environment")
      ->required();
  add_count_option(*command, "--show", options->show, 0, 1'000'000'000,
                   "Print the first N differing points, or new and gone conflicts");
  command->add_flag("--json", options->json, "Print one JSON object");
  CLI::Option* conflicts = command->add_flag(
      "--conflicts", options->conflicts,
      "Say instead which conflicts are new, worse, gone and the same; of any environments");
  add_conflict_comparison(*command, *options, conflicts);
  command->footer(
      "Prints how many colliding points are only in A, only in B and in both. Where both "
      "results\n"
      "have first poses, depths, clearances or an error budget, it prints how many of these, or "
      "of\n"
      "the near points, differ. It also prints what differs in the queries: model, trajectory,\n"
      "radius in metres.\n"
      "Exit code 0: the same points, first poses, depths, near points and clearances, even of\n"
      "different queries.\n"
      "Exit code 1: they differ.\n"
      "With --conflicts, exit code 1 says that B has new conflicts, worse ones, new groups that "
      "are\n"
      "too small to be listed, or answers another question. Conflicts are the same where their\n"
      "points are within the gap of each other; a part of B without such points of A is new.\n"
      "Exit code 6, with --conflicts: B cannot show that nothing is worse. It is undecided, did\n"
      "not search a place where A has a conflict, or is the same scan as A or an older one.\n"
      "Exit code 3: a file is not a result, or the results are about different environments.\n"
      "Example: clearway compare kdtree.h5 sweep.h5");
  command->callback([options, command, &exit_code] {
    const SearchedFiles &a = *options, &b = options->b;
    advising_to_run_again(
        *command,
        {{a.result, a.trajectory}, {b.result, b.trajectory.empty() ? a.trajectory : b.trajectory}},
        [&] { exit_code = run_compare(*options); });
  });
}

}  // namespace clearway::tool
