#include <memory>

#include "bench/experiments/bench.hpp"
#include "clearway/error.hpp"
#include "cli/commands.hpp"
#include "cli/options.hpp"
#include "cli/signals.hpp"

namespace clearway::tool {
namespace {

constexpr const char* kHowToResume = "the same command with --resume goes on from there";

struct Experiment {
  const char* name;
  void (*run)(Bench&);
  const char* help;
  bool of_any_scene = false;  ///< takes --scenes; the others need certain ones
};

constexpr Experiment kExperiments[] = {
    {"table", bench_table, "Colliding points of every engine on the four scenes (Table 1)", true},
    {"threads", bench_threads, "Speed by the number of threads (Fig. 1)"},
    {"grid", bench_grid, "Time of each step by grid resolution and layout (Fig. 2)"},
    {"datasets", bench_datasets, "Time of every engine and device on the four scenes (Fig. 3)",
     true},
    {"points", bench_points, "Time by the number of environment points, 111 samples (Fig. 4)"},
    {"accuracy", bench_accuracy, "Time and misclassified points, exact and approximate"},
    {"stability", bench_stability, "Where methods fail: origin, sparseness, radius, memory, poses"},
    {"scaling", bench_scaling, "Time by poses, model points, radius and cell size"},
};

/// Throws UsageError with the experiments that take --scenes.
void check_scenes(const Experiment& experiment, bool given) {
  if (!given || experiment.of_any_scene) return;
  std::string others;
  for (const Experiment& other : kExperiments) {
    if (other.of_any_scene) others += std::string(others.empty() ? "" : " and ") + other.name;
  }
  throw UsageError("--scenes is for " + others + "; " + experiment.name + " has scenes of its own");
}

void run_bench(const Experiment& experiment, const BenchOptions& options) {
  run_stoppable(options.output, kHowToResume, [&] {
    Bench bench(experiment.name, options);
    experiment.run(bench);
  });
}

/// Gives back --scenes.
CLI::Option* add_options(CLI::App& command, BenchOptions& options) {
  command.add_option("-o,--output", options.output, "The figures, a JSON file")
      ->type_name("FILE")
      ->required();
  command
      .add_option("--work", options.work,
                  "Folder for scenes, stores and results, which stay there; for one experiment at "
                  "a time and "
                  "one build of clearway")
      ->type_name("DIR")
      ->required();
  command
      .add_option("--size", options.size,
                  "small: minutes on 2 cores; full: the paper's sizes, for a machine with a GPU; "
                  "smoke: seconds, to try the command out")
      ->check(CLI::IsMember({"smoke", "small", "full"}))
      ->capture_default_str();
  command
      .add_option("--device", options.device,
                  "cpu measures no GPU; auto measures one where there is one")
      ->check(CLI::IsMember({"auto", "cpu", "cuda"}))
      ->capture_default_str();
  command
      .add_option("--repetitions", options.repetitions,
                  "Runs of every case; table and most of stability run each case once")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  CLI::Option* scenes =
      command
          .add_option("--scenes", options.scenes, "Scenes, for table and datasets (default: all)")
          ->delimiter(',')
          ->check(CLI::IsMember({"mine", "hall", "plant", "tunnel"}));
  command
      .add_option(
          "--limit", options.limit_seconds,
          "Seconds after which a run is stopped and counts as failed; --resume with a larger limit "
          "repeats such cases")
      ->check(CLI::Range(1.0, 86400.0))
      ->capture_default_str();
  const auto is_size = [](const std::string& text) {
    parse_size("a size", text);  // throws
    return std::string();
  };
  command.add_option("--memory", options.memory, "--memory of every run and conversion")
      ->check(is_size)
      ->capture_default_str();
  command.add_option("--device-memory", options.device_memory, "--device-memory of every run")
      ->check(is_size)
      ->capture_default_str();
  CLI::Option* force = command.add_flag("--force", options.force, "Replace an existing file");
  command.add_flag("--resume", options.resume, "Go on with a file of the same experiment")
      ->excludes(force);
  return scenes;
}

}  // namespace

void add_bench(CLI::App& program) {
  CLI::App* command = program.add_subcommand(
      "bench", "Measure Clearway: the paper's experiments and ours, as JSON for charts");
  command->require_subcommand(1);
  for (const Experiment& experiment : kExperiments) {
    const auto options = std::make_shared<BenchOptions>();
    CLI::App* one = command->add_subcommand(experiment.name, experiment.help);
    const CLI::Option* scenes = add_options(*one, *options);
    one->callback([&experiment, options, scenes] {
      check_scenes(experiment, scenes->count() > 0);
      run_bench(experiment, *options);
    });
  }
  command->footer(
      "Every case is a `clearway run` in a process of its own; tools/charts.py draws the files.\n"
      "Example: clearway bench table -o table.json --work /tmp/scenes");
}

}  // namespace clearway::tool
