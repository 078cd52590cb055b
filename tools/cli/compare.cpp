#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "cli/commands.hpp"
#include "cli/comparison_text.hpp"
#include "cli/conflicts/conflict_comparison.hpp"
#include "cli/run_again.hpp"
#include "cli/support/options.hpp"
#include "cli/support/signals.hpp"
#include "cli/support/standard_output.hpp"
#include "cli/verdict.hpp"
#include "io/result/check/compare_results.hpp"

namespace clearway::tool {
namespace {

struct CompareOptions {
  std::filesystem::path a, b;
  std::uint64_t show = 10;
  bool json = false;
  bool conflicts = false;
  ConflictComparison places;
};

bool run_compare(CompareOptions& options) {
  if (options.conflicts) {
    bool none_new = false;
    run_stoppable(options.b, kStartsAgain, [&] {
      none_new =
          compare_conflicts(options.places, options.a, options.b, options.show, options.json);
    });
    return none_new;
  }
  const ResultReader a(options.a), b(options.b);
  warn_of_doubts(a);
  warn_of_doubts(b);
  const Comparison comparison = compare_results(a, b, options.show);
  print(options.json ? comparison_json(comparison, a.name(), b.name())
                     : comparison_text(comparison, a.name(), b.name()));
  return comparison.equal();
}

}  // namespace

void add_compare(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<CompareOptions>();
  CLI::App* command =
      program.add_subcommand("compare", "Say how the colliding points of two results differ");
  command->add_option("A", options->a, "Result of clearway run")->type_name("FILE")->required();
  command->add_option("B", options->b, "Another result about the same environment")
      ->type_name("FILE")
      ->required();
  add_count_option(*command, "--show", options->show, 0, 1'000'000'000,
                   "Print the first N differing points, or new and gone conflicts");
  command->add_flag("--json", options->json, "Print one JSON object");
  CLI::Option* conflicts = command->add_flag(
      "--conflicts", options->conflicts,
      "Say instead which conflicts are new, worse, gone and the same; of any environments");
  add_conflict_comparison(*command, options->places, conflicts);
  command->footer(
      "Prints how many colliding points are only in A, only in B and in both. Where both "
      "results\n"
      "have first poses or clearances, it prints how many of them differ. It also prints what\n"
      "differs in the queries: model, trajectory, radius in metres.\n"
      "Exit code 0: the same points, first poses and clearances, even of different queries.\n"
      "Exit code 1: they differ.\n"
      "With --conflicts, exit code 1 says that B has new conflicts, worse ones, new groups that "
      "are\n"
      "too small to be listed, or answers another question. Conflicts are the same where their\n"
      "boxes overlap, grown by the gap. Each is matched once, the largest overlaps first. What\n"
      "is left is the same where each of its points is within the gap of points that A has.\n"
      "Exit code 3: a file is not a result, or the results are about different environments.\n"
      "Example: clearway compare kdtree.h5 sweep.h5");
  command->callback([options, command, &exit_code] {
    const ConflictComparison& places = options->places;
    const bool one_path = places.trajectory_b.empty();
    advising_to_run_again(*command,
                          {{options->a, places.trajectory},
                           {options->b, one_path ? places.trajectory : places.trajectory_b}},
                          [&] { exit_code = run_compare(*options) ? 0 : 1; });
  });
}

}  // namespace clearway::tool
