#include "bench/commands.hpp"

#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "bench/experiments/bench.hpp"
#include "bench/measure/scoring.hpp"
#include "bench/stages/set_engines.hpp"
#include "bench/stages/time_session.hpp"
#include "bench/stages/time_stages.hpp"
#include "clearway/error.hpp"
#include "cli/support/console.hpp"
#include "cli/support/options.hpp"
#include "cli/support/program.hpp"

namespace clearway::bench {
namespace {

constexpr const char* kHowToResume = "the same command with --resume goes on from there";

struct Experiment {
  const char* name;
  void (*run)(Bench&);
  const char* help;
  bool of_any_scene = false;  ///< takes --scenes; other experiments need certain scenes
  bool of_any_query = false;  ///< also takes --env, --model and --trajectory
};

constexpr Experiment kExperiments[] = {
    {"table", bench_table,
     "Colliding points and time of every engine on the four scenes (Table 1 and Fig. 3), or on the "
     "one that --env, --model and --trajectory name",
     true, true},
    {"threads", bench_threads, "Speed by the number of threads (Fig. 1)"},
    {"grid", bench_grid, "Time of each step by grid resolution and layout (Fig. 2)"},
    {"points", bench_points,
     "Time by the number of environment points, 111 samples at size full (Fig. 4)"},
    {"accuracy", bench_accuracy, "Time and misclassified points, exact and approximate"},
    {"stability", bench_stability, "Where methods fail: origin, sparseness, radius, memory, poses"},
    {"scaling", bench_scaling, "Time by poses, model points, radius and cell size"},
    {"share", bench_share,
     "What share of a scene a search touches, and what touching more than that would cost", true},
    {"hard", bench_hard, "Time of the sweep and the k-d tree on cases that are hard for a sweep"},
    {"equality", bench_equality,
     "Compares the results of all engines, devices and modes with the sweep's on the CPU, byte by "
     "byte",
     true, true},
    {"shards", bench_shards,
     "Work of the largest of 16 shards over the mean, by estimate and measured", true, true},
    {"surfaces", bench_surfaces,
     "A mesh as a surface and as points on it: time, and points missed (on the hall, unless "
     "--env, --model and --trajectory name others)",
     false, true},
    {"seen", bench_seen,
     "What it costs to know more than the set: time by question, and of seen space by beams, "
     "cubes, "
     "path and threads",
     true},
    {"section", bench_section,
     "Time of a section by bins, cells, length of the load, threads and device, beside every pair "
     "of a point and a pose, and beside runs of many widths",
     true},
};

/// Throws UsageError, which lists the experiments that take --scenes, where one of the others is
/// given that option.
void check_scenes(const Experiment& experiment, bool given) {
  if (!given || experiment.of_any_scene) return;
  std::string others;
  for (const Experiment& other : kExperiments) {
    if (other.of_any_scene) others += std::string(others.empty() ? "" : ", ") + other.name;
  }
  throw UsageError("--scenes is for " + others + "; " + experiment.name + " has scenes of its own");
}

/// Runs an experiment and returns the exit code.
int run_bench(const Experiment& experiment, const BenchOptions& options) {
  try {
    tool::run_stoppable(options.output, kHowToResume, [&] {
      Bench bench(experiment.name, options);
      experiment.run(bench);
    });
  } catch (const ResultsDiffer& differ) {
    spdlog::error("{}", differ.what());
    return kDiffers;
  }
  return kDone;
}

void add_files(CLI::App& command, BenchOptions& options) {
  command.add_option("-o,--output", options.output, "The figures, a JSON file")
      ->type_name("FILE")
      ->required();
  command
      .add_option("--work", options.work,
                  "Folder for scenes, stores and results, which stay there; for one experiment at "
                  "a time and one build of clearway")
      ->type_name("DIR")
      ->required();
  command
      .add_option("--program", options.program,
                  "The clearway that is measured (default: the one beside this program)")
      ->type_name("FILE");
  CLI::Option* force = command.add_flag("--force", options.force, "Replace an existing file");
  command.add_flag("--resume", options.resume, "Go on with a file of the same experiment")
      ->excludes(force);
}

void add_cases(CLI::App& command, BenchOptions& options) {
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
                  "Runs of every case; equality, points and most of stability run each case once")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  command
      .add_option(
          "--limit", options.limit_seconds,
          "Seconds after which a run is stopped and counts as failed; --resume with a larger limit "
          "repeats such cases")
      ->check(CLI::Range(1.0, 86400.0))
      ->capture_default_str();
  command.add_flag("--cold", options.cold,
                   "Drop the store from the page cache before every run, so that it is read from "
                   "the disk");
}

void add_bounds(CLI::App& command, BenchOptions& options) {
  const auto is_size = [](const std::string& text) {
    tool::parse_size("a size", text);  // throws for text that is no size
    return std::string();
  };
  command.add_option("--memory", options.memory, "--memory of every run and conversion")
      ->check(is_size)
      ->capture_default_str();
  command.add_option("--device-memory", options.device_memory, "--device-memory of every run")
      ->check(is_size)
      ->capture_default_str();
  command
      .add_option("--gpus", options.gpus,
                  "--gpus of every run on a GPU, for example 0,1 (default: the first with room)")
      ->type_name("N,...");
}

/// Adds --scenes and returns the option.
const CLI::Option* add_scenes(CLI::App& command, BenchOptions& options) {
  return command
      .add_option("--scenes", options.scenes,
                  "Scenes, for table, share, equality, shards, seen and section "
                  "(default: all)")
      ->delimiter(',')
      ->check(CLI::IsMember({"mine", "hall", "plant", "tunnel"}));
}

/// Adds --env, --model and --trajectory, of which all or none are to be given.
void add_query(CLI::App& command, std::filesystem::path& environment, std::filesystem::path& model,
               std::filesystem::path& trajectory, bool required) {
  CLI::Option* files[] = {command.add_option("--env", environment, "A store of clearway convert"),
                          command.add_option("--model", model, "The model's points"),
                          command.add_option("--trajectory", trajectory, "The poses")};
  for (CLI::Option* file : files) {
    file->type_name("FILE")->required(required);
    for (CLI::Option* other : files) {
      if (other != file) file->needs(other);
    }
  }
}

void add_radius_and_threads(CLI::App& command, double& radius, int& threads) {
  command.add_option("--radius", radius, "Search radius in metres")
      ->type_name("METRES")
      ->transform(tool::positive_length())
      ->capture_default_str();
  tool::add_threads_option(command, threads);
}

}  // namespace

void add_experiments(CLI::App& program, int& exit_code) {
  for (const Experiment& experiment : kExperiments) {
    const auto options = std::make_shared<BenchOptions>();
    CLI::App* command = program.add_subcommand(experiment.name, experiment.help);
    add_files(*command, *options);
    add_cases(*command, *options);
    const CLI::Option* scenes = add_scenes(*command, *options);
    add_bounds(*command, *options);
    if (experiment.of_any_query) {
      add_query(*command, options->also.store, options->also.model, options->also.trajectory,
                false);
    }
    command->callback([&experiment, &exit_code, options, scenes] {
      check_scenes(experiment, scenes->count() > 0);
      exit_code = run_bench(experiment, *options);
    });
  }
  program.footer(
      "Every case of an experiment is a `clearway run` in a process of its own.\n"
      "tools/charts.py draws the files.\n"
      "Example: clearway-bench table -o table.json --work /tmp/scenes");
}

void add_stages(CLI::App& program) {
  const auto options = std::make_shared<StageOptions>();
  CLI::App* command = program.add_subcommand(
      "stages", "Times reading alone and, with a GPU, sending and searching alone; prints JSON");
  add_query(*command, options->environment, options->model, options->trajectory, true);
  add_radius_and_threads(*command, options->radius, options->threads);
  command->add_option("--slots", options->slots, "Pages in flight")
      ->type_name("N")
      ->check(CLI::Range(1, 4096))
      ->capture_default_str();
  command->add_option("--cells", options->cells, "Cells of a page")
      ->type_name("N")
      ->check(CLI::Range(1, 4096))
      ->capture_default_str();
  command->add_flag("--cold", options->cold, "Drop the store from the page cache before");
  command->callback([options] { tool::print(time_stages(*options).dump(2) + "\n"); });
}

void add_session(CLI::App& program) {
  const auto options = std::make_shared<SessionTimes>();
  CLI::App* command = program.add_subcommand(
      "session", "Times questions of one pose that a session answers; prints JSON");
  add_query(*command, options->environment, options->model, options->trajectory, true);
  add_radius_and_threads(*command, options->radius, options->threads);
  const auto count = [&](const char* name, std::uint64_t& value, const char* help) {
    command->add_option(name, value, help)->type_name("N")->capture_default_str();
  };
  command
      ->add_option("--distance", options->distance,
                   "Ask for the least distance up to this; 0: only for the colliding points")
      ->type_name("METRES")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_option("--askers", options->askers, "Threads that ask at the same time")
      ->type_name("N")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  count("--questions", options->questions, "Questions that are timed, after as many that are not");
  count("--further", options->repeat_memory, "Questions after which the memory is compared");
  command->add_option("--device", options->device, "Where questions are answered")
      ->check(CLI::IsMember({"auto", "cpu", "cuda"}))
      ->capture_default_str();
  command
      ->add_option("--device-memory", options->device_memory_bytes,
                   "Memory bound of each GPU (default: 2G, or what is free)")
      ->transform(CLI::AsSizeValue(false))
      ->type_name("SIZE");
  command->add_flag("--one-run", options->one_run,
                    "Compare the whole trajectory in one question with its poses one by one");
#ifdef CLEARWAY_NANOFLANN
  command->add_flag("--peer", options->peer, "Time nanoflann on some of the poses, too");
#endif
  command->callback([options] { tool::print(time_session(*options).dump(2) + "\n"); });
}

void add_search(CLI::App& program) {
  const auto options = std::make_shared<SetEngines>();
  CLI::App* command = program.add_subcommand(
      "search",
      "Searches with engines that are set as no clearway run sets them, so that the result may not "
      "be exact; writes it and prints JSON");
  add_query(*command, options->environment, options->model, options->trajectory, true);
  command->add_option("-o,--output", options->output, "The result, an HDF5 file")
      ->type_name("FILE")
      ->required();
  add_radius_and_threads(*command, options->radius, options->search.threads);
  const auto choose = [&](const char* name, auto& chosen, auto usual, auto other,
                          const std::pair<const char*, const char*>& names, const char* help) {
    chosen = usual;
    command
        ->add_option_function<std::string>(
            name,
            [&chosen, usual, other, names](const std::string& text) {
              chosen = text == names.first ? usual : other;
            },
            help)
        ->check(CLI::IsMember({names.first, names.second}))
        ->default_str(names.first);
  };
  choose("--engine", options->search.engine, Engine::kSweep, Engine::kGrid, {"sweep", "grid"},
         "The engine that searches");
  choose("--device", options->search.device, Device::kCpu, Device::kCuda, {"cpu", "cuda"},
         "Where it searches");
  command->add_option("--gpus", options->search.gpus, "As of clearway run")->delimiter(',');
  tool::add_size_option(*command, "--memory", options->search.memory_bytes, "As of clearway run");
  tool::add_size_option(*command, "--device-memory", options->search.device_memory_bytes,
                        "As of clearway run");
  const auto length = [&](const std::string& name, double& metres, const char* help) {
    command->add_option(name, metres, help)
        ->type_name("METRES")
        ->transform(tool::positive_length());
  };
  length(kToleranceOption, options->settings.tolerance,
         "Engine sweep may decide wrongly for points within this of the radius");
  length(kFieldVoxelOption, options->settings.field_voxel,
         "Voxel of the sweep engine's model field (default: chosen)");
  length(kGridCellOption, options->settings.grid.grid_cell,
         "Grid cell of engine grid (default: chosen)");
  choose(kPrecisionOption, options->settings.grid.precision, GridPrecision::kExact,
         GridPrecision::kFloat, {"exact", "float"},
         "float: engine grid decides in single precision alone");
  command->callback([options] { tool::print(search_with_set_engines(*options).dump(2) + "\n"); });
}

}  // namespace clearway::bench
