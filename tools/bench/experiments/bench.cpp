#include "bench/experiments/bench.hpp"

#include <hdf5.h>
#include <spdlog/spdlog.h>
#include <tbb/info.h>
#include <tbb/version.h>
#include <unistd.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "bench/commit.hpp"
#include "bench/measure/page_cache.hpp"
#include "bench/measure/program.hpp"
#include "bench/stages/set_engines.hpp"
#include "bench/variants/variants.hpp"
#include "clearway/error.hpp"

#ifdef CLEARWAY_CUDA
#include <cuda_runtime_api.h>

#include "gpu/devices.hpp"
#endif

namespace clearway::bench {
namespace {

/// The value of the first line "key<separator>value" of a file, quotes left out; empty where there
/// is none.
std::string value_in(const char* file, std::string_view key, char separator) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with(key)) continue;
    const std::size_t at = line.find(separator);
    if (at == std::string::npos) continue;
    std::string value = line.substr(at + 1);
    std::erase(value, '"');
    return value.substr(std::min(value.find_first_not_of(" \t"), value.size()));
  }
  return {};
}

nlohmann::ordered_json gpus() {
  auto names = nlohmann::ordered_json::array();
#ifdef CLEARWAY_CUDA
  for (int i = 0; i < cuda_device_count(); ++i) names.push_back(cuda_device_name(i));
#endif
  return names;
}

/// Processor, cores, memory, GPUs and system of this machine.
nlohmann::ordered_json machine_description() {
  return {{"processor", value_in("/proc/cpuinfo", "model name", ':')},
          {"cores", tbb::info::default_concurrency()},  // the cores that this process may use
          {"memory_bytes", static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES)) *
                               static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE))},
          {"gpus", gpus()},
          {"system", value_in("/etc/os-release", "PRETTY_NAME", '=')}};
}

/// Version and commit of this program, how it was built, compiler and libraries.
nlohmann::ordered_json program_description() {
  nlohmann::ordered_json libraries{
      {"hdf5", std::to_string(H5_VERS_MAJOR) + '.' + std::to_string(H5_VERS_MINOR) + '.' +
                   std::to_string(H5_VERS_RELEASE)},
      {"onetbb", TBB_VERSION_STRING},
      {"eigen", std::to_string(EIGEN_WORLD_VERSION) + '.' + std::to_string(EIGEN_MAJOR_VERSION) +
                    '.' + std::to_string(EIGEN_MINOR_VERSION)}};
#ifdef CLEARWAY_CUDA
  libraries["cuda"] =
      std::to_string(CUDART_VERSION / 1000) + '.' + std::to_string(CUDART_VERSION % 1000 / 10);
#endif
  return {{"version", CLEARWAY_VERSION},
          {"commit", kCommit},
          {"build", CLEARWAY_BUILD},
          {"compiler", __VERSION__},
          {"libraries", libraries}};
}

bool use_cuda(const std::string& device) {
#ifdef CLEARWAY_CUDA
  const bool found = cuda_device_count() > 0;
#else
  const bool found = false;
#endif
  if (device == "cuda" && !found) throw ResourceError("no GPU; --device cpu measures without");
  return found && device != "cpu";
}

/// The description of the measured program; that of this program where they were built together.
Json description_of(const BenchOptions& options, const Program& program) {
  if (options.program.empty()) return program_description();
  std::string version = program.output_of({"--version"});
  version.erase(version.find_last_not_of('\n') + 1);
  return {{"version", version}, {"commit", "unknown"}, {"build", program.path().string()}};
}

/// The header of an experiment's file. Options that came with later versions are in it only where
/// they are used, so that older files stay comparable.
Json header_of(const std::string& experiment, const BenchOptions& options, bool cuda,
               const Json& program) {
  Json parameters{{"device", cuda ? "cuda" : "cpu"},
                  {"repetitions", options.repetitions},
                  {"scenes", options.scenes},
                  {"memory", options.memory},
                  {"device_memory", options.device_memory},
                  {"limit", options.limit_seconds}};
  if (!options.gpus.empty()) parameters["gpus"] = options.gpus;
  if (options.cold) parameters["cold"] = true;
  if (!options.also.store.empty()) parameters["env"] = options.also.store.string();
  return {{"experiment", experiment},
          {"size", options.size},
          {"machine", machine_description()},
          {"clearway", program},
          {"parameters", std::move(parameters)}};
}

std::vector<std::string> joined(std::vector<std::string> a, const std::vector<std::string>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// The locked work folder, with a note of the program that it belongs to.
WorkFolder work_folder_at(const std::filesystem::path& path, const Json& program) {
  WorkFolder folder(path);
  const auto remark = folder.note_program({{"version", program["version"]},
                                           {"commit", program["commit"]},
                                           {"build", program["build"]}});
  if (remark) spdlog::warn("{}", *remark);
  return folder;
}

/// Seconds of a case after which it is not repeated: at size small, where the whole evaluation has
/// to take minutes, and at size full.
constexpr double kEnoughSeconds = 3, kEnoughSecondsFull = 30;

/// The clearance of a truth, metres: beyond the radius by more than any method is expected to err.
constexpr const char* kTruthClearance = "0.3";

}  // namespace

EngineChoice EngineChoice::with(const std::vector<std::string>& more) const {
  return {name, joined(options, more), exact};
}

Bench::Bench(const std::string& experiment, const BenchOptions& options)
    : options_(options),
      program_(options.program),
      own_(std::filesystem::read_symlink("/proc/self/exe")),
      description_(description_of(options, program_)),
      work_(work_folder_at(options.work, description_)),
      cuda_(use_cuda(options.device)),
      record_(options_.output, header_of(experiment, options, cuda_, description_), options.resume,
              options.force) {
  if (record_.empty() || !may_have_changed(description_)) return;
  spdlog::warn("{}: its cases are of commit {} too, but the source may have changed since",
               options_.output.string(), description_["commit"].get<std::string>());
}

SceneFiles Bench::scene(const std::string& name) { return scene(name, options_.size); }

SceneFiles Bench::scene(const std::string& name, const std::string& of_size) {
  const std::string label = name + "-" + of_size;
  SceneFiles files = made(name, label, scene_size(name, of_size));
  files.store = store(label, files.environment);
  return files;
}

SceneFiles Bench::scanned(const std::string& name, std::uint64_t points) {
  scene::Sizes size = scene_size(name, options_.size);
  const std::string label =
      name + "-" + options_.size + (points == size.points ? "" : "-" + std::to_string(points));
  size.points = points;
  SceneFiles files = made(name, label, size);
  files.store = store(label + "-origins", files.environment,
                      {"--origins", (files.environment.parent_path() / "origins.csv").string()});
  return files;
}

SceneFiles Bench::made(const std::string& name, const std::string& label,
                       const scene::Sizes& size) {
  const std::filesystem::path folder = work() / label;
  SceneFiles files{.environment = folder / "environment.las",
                   .store = {},
                   .model = folder / "model.ply",
                   .trajectory = folder / "trajectory.txt"};
  if (!std::filesystem::exists(files.trajectory)) {
    spdlog::info("{}: making the scene", folder.string());
    make_scene(folder, name, size);
  }
  return files;
}

SceneFiles Bench::resized(const std::string& name, SceneFiles files, std::uint64_t model_points,
                          std::uint64_t poses) {
  const auto folder = work() / (name + "-" + std::to_string(model_points) + "-points-" +
                                std::to_string(poses) + "-poses");
  files.model = folder / "model.ply";
  files.trajectory = folder / "trajectory.txt";
  if (!std::filesystem::exists(files.trajectory))
    make_scene(folder, name, {1, model_points, poses});
  return files;
}

void Bench::make_scene(const std::filesystem::path& folder, const std::string& name,
                       const scene::Sizes& size) const {
  program_.output_of({"scene", name, "-o", folder.string(), "--points", std::to_string(size.points),
                      "--model-points", std::to_string(size.model_points), "--poses",
                      std::to_string(size.poses), "--force"});
}

std::filesystem::path Bench::store(const std::string& name,
                                   const std::filesystem::path& environment,
                                   const std::vector<std::string>& options) {
  std::filesystem::path path = work() / (name + ".h5");
  if (!std::filesystem::exists(path)) {
    spdlog::info("{}: converting", path.string());
    program_.output_of(joined({"convert", environment.string(), "-o", path.string(), "--memory",
                               options_.memory, "--force"},
                              options));
  }
  return path;
}

void Bench::run(const SceneFiles& files, const std::filesystem::path& result,
                const std::vector<std::string>& run_options) const {
  const auto [program, arguments] = command(files, result, run_options);
  program.output_of(arguments);
}

std::filesystem::path Bench::answer(const std::string& name, const SceneFiles& files,
                                    const std::vector<std::string>& run_options) {
  std::filesystem::path path = work_.answers() / (name + "-" + options_.size + ".h5");
  std::filesystem::create_directories(work_.answers());
  if (!std::filesystem::exists(path)) run(files, path, run_options);
  return path;
}

std::filesystem::path Bench::truth(const std::string& name, const SceneFiles& files) {
  const EngineChoice sweep = engine_here("sweep").with({"--clearance", kTruthClearance});
  return answer("truth-" + name, files, sweep.options);
}

SceneFiles Bench::shifted(const std::string& name, const SceneFiles& files, const Vec3& shift) {
  const std::string of_shift = name + "-" + options_.size + "-shifted-" +
                               std::to_string(std::llround(shift.x)) + "-" +
                               std::to_string(std::llround(shift.y));
  SceneFiles moved = files;
  moved.environment = work() / "shifted.las";
  moved.trajectory = work() / (of_shift + ".txt");
  moved.store = work() / (of_shift + ".h5");
  if (!std::filesystem::exists(moved.store)) {
    write_shifted_poses(files.trajectory, moved.trajectory, shift);
    shift_environment(files.environment, moved.environment, shift);
    store(of_shift, moved.environment);
    std::filesystem::remove(moved.environment);
  }
  return moved;
}

Json Bench::convert(const std::string& key, const std::filesystem::path& environment,
                    const std::filesystem::path& path,
                    const std::vector<std::string>& convert_options) {
  const ProgramRun run = program_.run(joined({"convert", environment.string(), "-o", path.string(),
                                              "--memory", options_.memory, "--force"},
                                             convert_options),
                                      options_.limit_seconds);
  if (run.exit_code != 0) return {{"failed", finding(key, run, Refusal::kMemory)}};
  return {{"convert_seconds", run.wall_seconds},
          {"convert_peak_bytes", run.peak_bytes},
          {"store_bytes", std::filesystem::file_size(path)}};
}

EngineChoice Bench::engine(const std::string& name) const {
  const std::string engine = name.substr(0, name.find(' '));
  const std::string device = name.ends_with("cuda") ? "cuda" : "cpu";
  std::vector<std::string> run_options{"--engine", engine, "--device", device};
  const bool exact = name.find("float") == std::string::npos;
  if (!exact) run_options = joined(std::move(run_options), {kPrecisionOption, "float"});
  return {name, run_options, exact};
}

EngineChoice Bench::engine_here(const std::string& name) const {
  return engine(name + (cuda_ ? " cuda" : " cpu"));
}

std::vector<EngineChoice> Bench::exact_engines() const {
  std::vector<EngineChoice> engines{engine("kdtree cpu"), engine("sweep cpu")};
  if (!full() || !cuda_) engines.push_back(engine("grid cpu"));
  if (cuda_) {
    engines.push_back(engine("grid cuda"));
    engines.push_back(engine("sweep cuda"));
  }
  return engines;
}

Bench::Command Bench::command(const SceneFiles& files, const std::filesystem::path& result,
                              const std::vector<std::string>& run_options) const {
  const auto given = [&](const char* word) {
    return std::find(run_options.begin(), run_options.end(), word) != run_options.end();
  };
  const bool sets_engine = std::ranges::any_of(kSettingOptions, given);
  std::vector<std::string> arguments{sets_engine ? "search" : "run",
                                     "--env",
                                     files.store.string(),
                                     "--model",
                                     files.model.string(),
                                     "--trajectory",
                                     files.trajectory.string(),
                                     "-o",
                                     result.string()};
  if (!sets_engine) arguments = joined(std::move(arguments), {"--force", "--json"});
  if (!given("--radius")) arguments = joined(std::move(arguments), {"--radius", kRadius});
  if (given("cuda") && !options_.gpus.empty()) {
    arguments = joined(std::move(arguments), {"--gpus", options_.gpus});
  }
  if (given("cuda") && !given("--device-memory")) {
    arguments = joined(std::move(arguments), {"--device-memory", options_.device_memory});
  }
  if (!given("--memory")) arguments = joined(std::move(arguments), {"--memory", options_.memory});
  return {sets_engine ? own_ : program_, joined(std::move(arguments), run_options)};
}

Json Bench::measure(const std::string& key, Json parameters, const SceneFiles& files,
                    const std::vector<std::string>& run_options, const Judge& judge,
                    std::optional<int> repetitions, Refusal expected) {
  const std::filesystem::path result = work() / "result.h5";
  return measure_program(key, std::move(parameters), files, command(files, result, run_options),
                         result, judge, repetitions, expected);
}

Json Bench::measure_section(const std::string& key, Json parameters, const SceneFiles& files,
                            const std::vector<std::string>& find_options) {
  const std::filesystem::path section = work() / "section.h5";
  std::vector<std::string> arguments{"section",
                                     "find",
                                     "--env",
                                     files.store.string(),
                                     "--trajectory",
                                     files.trajectory.string(),
                                     "-o",
                                     section.string(),
                                     "--memory",
                                     options_.memory,
                                     "--device-memory",
                                     options_.device_memory,
                                     "--force",
                                     "--json"};
  return measure_program(key, std::move(parameters), files,
                         {program_, joined(std::move(arguments), find_options)}, section, {}, {},
                         Refusal::kMemory);
}

Json Bench::measure_program(const std::string& key, Json parameters, const SceneFiles& files,
                            const Command& command, const std::filesystem::path& result,
                            const Judge& judge, std::optional<int> repetitions, Refusal expected) {
  if (const Json* known = record_.find(key)) return *known;
  spdlog::info("{}", key);
  Json one{{"key", key}, {"parameters", std::move(parameters)}, {"runs", Json::array()}};
  const double enough = full() ? kEnoughSecondsFull : kEnoughSeconds;
  double seconds = 0;
  for (int i = 0; i < repetitions.value_or(options_.repetitions); ++i) {
    if (seconds > enough) break;
    if (options_.cold) drop_from_page_cache(files.store);
    const ProgramRun run = command.program.run(command.arguments, options_.limit_seconds);
    if (run.exit_code != 0) {
      one["failed"] = finding(key, run, expected);
      return record_.add(std::move(one));
    }
    seconds += run.wall_seconds;
    Json report = Json::parse(run.output);
    report["wall_seconds"] = run.wall_seconds;
    report["cpu_seconds"] = run.cpu_seconds;
    report["peak_resident_bytes"] = run.peak_bytes;
    one["runs"].push_back(std::move(report));
  }
  if (judge) one["findings"] = judge(result);
  return record_.add(std::move(one));
}

Json Bench::finding(const std::string& key, const ProgramRun& failed, Refusal expected) const {
  Json failure = failure_of(failed, options_.limit_seconds);
  if (!is_finding(failed, expected)) throw ResourceError(key + ": " + failed.log);
  spdlog::warn("{}: counted as failed: {}", key, reason_of(failure));
  return failure;
}

Json Bench::keep(const std::string& key, Json parameters, const std::function<Json()>& findings) {
  if (const Json* known = record_.find(key)) return *known;
  spdlog::info("{}", key);
  Json found = findings();
  return record_.add(
      {{"key", key}, {"parameters", std::move(parameters)}, {"findings", std::move(found)}});
}

void Bench::conclude(Json findings) {
  record_.add({{"key", "all"}, {"parameters", Json::object()}, {"findings", std::move(findings)}});
}

}  // namespace clearway::bench
