#include "clearway/merge.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <vector>

#include "cli/commands.hpp"
#include "cli/support/console.hpp"
#include "cli/support/lengths.hpp"
#include "cli/support/options.hpp"
#include "cli/support/program.hpp"
#include "cli/support/program_json.hpp"
#include "cli/verdict.hpp"
#include "core/describe/answer.hpp"
#include "core/util/format.hpp"
#include "core/util/stopwatch.hpp"
#include "io/files/facts_json.hpp"
#include "io/files/file.hpp"

namespace clearway::tool {
namespace {

struct MergeCommand {
  std::vector<std::filesystem::path> parts;
  std::filesystem::path output;
  MergeOptions merge;
  bool fail_on_collision = false;
  bool json = false;
};

nlohmann::ordered_json json_of(const MergeCommand& options, const MergeReport& report,
                               double seconds) {
  nlohmann::ordered_json out = program_json({{"output", options.output}});
  out["radius"] = report.parameters.radius;
  out["environment_points"] = report.environment_points;
  out["model_points"] = report.model_points;
  add_answer(report, {}, out);
  add_facts(out, report);
  for (std::size_t i = 0; i < report.part_warnings.size(); ++i) {
    out["warnings"][i]["parts"] = report.part_warnings[i].parts;
  }
  out["seconds"] = seconds;
  return out;
}

Verdict run_merge(MergeCommand& options) {
  const Stopwatch total;
  ConsoleProgress progress;
  watch_call(options.merge, progress);
  raise_open_files_limit(options.parts.size());
  const MergeReport report = merge(options.parts, options.output, options.merge);
  const std::string sentence = verdict_text(report, {}, symbol_of_unit(report.length_unit),
                                            caveat_of(report.part_warnings.size()));
  spdlog::info("{}: {} {}; {}", options.output.string(),
               report.was_finished ? "is there already, of" : "merged",
               counted(report.parts, "part"),
               found_text(report.colliding_points, report.environment_points));
  if (options.json) {
    spdlog::info("{}", sentence);
    print(indented_text(json_of(options, report, total.seconds())));
  } else {
    print(sentence + "\n");
  }
  return report.verdict();
}

}  // namespace

void add_merge(CLI::App& program, int& exit_code) {
  const auto options = std::make_shared<MergeCommand>();
  CLI::App* command =
      program.add_subcommand("merge", "Make one result of the parts that run --shard wrote");
  command->add_option("PART", options->parts, "All parts of one run, in any order")
      ->type_name("FILE...")
      ->required();
  add_file(*command, "-o,--output", options->output, "The result, an HDF5 file")->required();
  add_threads_option(*command, options->merge.threads);
  add_memory_option(*command, options->merge.memory_bytes);
  CLI::Option* force =
      command->add_flag("--force", options->merge.overwrite, "Overwrite an existing result");
  command->add_flag("--resume", options->merge.resume, "Leave a result of the same parts as it is")
      ->excludes(force);
  command->add_flag("--strict", options->merge.strict,
                    "Treat warnings of the parts' runs as errors: nothing is merged (exit code 3)");
  command->add_flag(
      "--fail-on-collision", options->fail_on_collision,
      "Exit with code 1 where a point collides, and 6 where the verdict is undecided");
  command->add_flag("--json", options->json, "Print one JSON object about the result");
  command->footer(
      "The result has the bytes of the run without --shard. It refuses parts of different runs,\n"
      "parts that are missing or there twice, and damaged ones. Warnings of their runs are\n"
      "repeated, each once.\n"
      "Example: clearway merge part-*.h5 -o out.h5");
  command->callback([options, &exit_code] {
    run_stoppable(options->output, kStartsAgain, [&] {
      const Verdict verdict = run_merge(*options);
      if (options->fail_on_collision) exit_code = exit_code_of(verdict);
    });
  });
}

}  // namespace clearway::tool
