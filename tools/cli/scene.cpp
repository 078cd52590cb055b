#include "scene/scene.hpp"

#include <spdlog/spdlog.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "clearway/error.hpp"
#include "cli/commands.hpp"
#include "cli/support/console.hpp"
#include "cli/support/options.hpp"
#include "core/util/format.hpp"
#include "io/files/file.hpp"
#include "io/files/pending_file.hpp"
#include "scene/write.hpp"

namespace clearway::tool {
namespace {

struct SceneOptions {
  std::string kind;
  std::filesystem::path folder;
  std::optional<std::uint64_t> points, model_points, poses;
  std::uint64_t seed = 1;
  std::string environment;
  int threads = 0;
  bool force = false;
};

constexpr const char* kExamples = R"(
Writes environment.las, model.ply, trajectory.txt and origins.csv, the places of
the scanner, in metres with z up. All but the road are like those of the paper,
and the same seed gives the same bytes.
Scenes (environment points, model points, poses; the defaults):
  hall     55,872,714  214,489   17,234  a hall along a conveyor; a car body
  plant   350,109,065  434,700  398,999  the same, larger, a pose every 2 mm
  mine    806,183,400  100,000   17,795  galleries scanned stop and go
  tunnel   18,919,000   28,622   19,392  a railway tunnel; a wagon
  road     20,000,000  100,000    4,000  a road through a village; a lorry

Examples:
  clearway scene hall -o hall --points 5000000
  clearway scene mine -o mine --environment - | clearway convert - -o mine.h5)";

scene::Sizes sizes_of(const SceneOptions& options) {
  const scene::Sizes full = scene::full_sizes(scene::kind_named(options.kind));
  return {options.points.value_or(full.points), options.model_points.value_or(full.model_points),
          options.poses.value_or(full.poses)};
}

File standard_output() {
  if (::isatty(STDOUT_FILENO) == 1) {
    throw UsageError("--environment - writes LAS, which is binary: pipe or redirect it");
  }
  const int descriptor = ::dup(STDOUT_FILENO);
  if (descriptor < 0) throw ResourceError("standard output: cannot open: it is closed");
  return File::adopt(descriptor, "standard output");
}

/// Throws ResourceError where the disk is too small, at once instead of after minutes.
void check_disk_space(const std::filesystem::path& folder, std::uint64_t points) {
  constexpr std::uint64_t kBytesAPoint = 20;
  const std::uint64_t free = free_disk_bytes(folder);
  if (free / kBytesAPoint < points) {
    throw ResourceError(folder.string() + ": the environment needs " +
                        format_size(points * kBytesAPoint) + ", the disk has " + format_size(free) +
                        " free; fewer --points, or --environment - to pipe it on");
  }
}

/// Writes the environment to standard output. Where that fails, the files of the scene are removed,
/// because they belong to no environment.
void pipe_environment(const scene::Scene& made, const SceneOptions& options, File& pipe,
                      ConsoleProgress& progress) {
  try {
    scene::write_environment(made, options.seed, pipe, options.threads, progress);
  } catch (...) {
    for (const char* name : {"model.ply", "trajectory.txt", "origins.csv"}) {
      std::error_code error;
      std::filesystem::remove(options.folder / name, error);
    }
    throw;
  }
}

/// Writes the scene's files; all are complete under temporary names before the first gets its own.
/// An environment for standard output comes after them.
void make_scene_files(const SceneOptions& options) {
  const auto sizes = sizes_of(options);
  std::optional<File> to_stdout;
  if (options.environment == "-") to_stdout.emplace(standard_output());
  std::error_code error;
  std::filesystem::create_directories(options.folder, error);
  if (error) {
    throw system_failure(options.folder.string() + ": cannot create the folder", error.value());
  }
  PendingFile model(options.folder / "model.ply", options.force);
  PendingFile trajectory(options.folder / "trajectory.txt", options.force);
  PendingFile origins(options.folder / "origins.csv", options.force);
  std::optional<PendingFile> environment;
  if (!to_stdout) {
    environment.emplace(options.folder / "environment.las", options.force);
    check_disk_space(options.folder, sizes.points);
  }

  const auto made = scene::make_scene(scene::kind_named(options.kind), sizes, options.seed);
  scene::write_model(*made, File::create(model.partial()));
  scene::write_trajectory(*made, File::create(trajectory.partial()));
  scene::write_origins(*made, File::create(origins.partial()));
  ConsoleProgress progress;
  if (!to_stdout) {
    scene::write_environment(*made, options.seed, File::create(environment->partial()),
                             options.threads, progress);
    environment->publish();
  }
  model.publish();
  trajectory.publish();
  origins.publish();
  // Last, so that whoever reads the pipe finds the origins of its points.
  if (to_stdout) pipe_environment(*made, options, *to_stdout, progress);
  spdlog::info("{}: {}, {}, {}", options.folder.string(),
               counted(sizes.points, "environment point"),
               counted(sizes.model_points, "model point"), counted(sizes.poses, "pose"));
}

}  // namespace

void add_scene(CLI::App& program) {
  CLI::App* command = program.add_subcommand(
      "scene",
      "Make a scan, a model and a path to try Clearway on: a road, a hall, a plant, a mine or a "
      "tunnel");
  const auto options = std::make_shared<SceneOptions>();
  command->add_option("kind", options->kind, "Which scene, see below")
      ->required()
      ->check(CLI::IsMember({"hall", "plant", "mine", "tunnel", "road"}));
  command->add_option("-o,--output", options->folder, "Folder for the files, created if missing")
      ->required()
      ->type_name("DIR");
  const auto count = [&](const char* name, std::optional<std::uint64_t>& value, std::uint64_t most,
                         const char* help) {
    command->add_option(name, value, help)
        ->check(CLI::Range(std::uint64_t{1}, most))
        ->type_name("N");
  };
  count("--points", options->points, 1'000'000'000'000,
        "Environment points: changes the density, not the extent (default: the paper's)");
  count("--model-points", options->model_points, 100'000'000,
        "Model points (default: the paper's)");
  count("--poses", options->poses, 1'000'000'000, "Poses of the trajectory (default: the paper's)");
  command->add_option("--seed", options->seed, "Seed of all random numbers")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command
      ->add_option("--environment", options->environment,
                   "\"-\" writes the environment to standard output instead of a file")
      ->check(CLI::IsMember({"-"}));
  add_threads_option(*command, options->threads);
  command->add_flag("--force", options->force, "Overwrite existing files");
  command->footer(kExamples);
  command->callback([options] {
    run_stoppable(options->folder, kStartsAgain, [&] { make_scene_files(*options); });
  });
}

}  // namespace clearway::tool
