#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <stdlib.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>

#include "clearway/clearway.hpp"
#include "clearway/model.hpp"
#include "clearway/store.hpp"
#include "clearway/trajectory.hpp"
#include "clearway/vehicle.hpp"
#include "cli/commands.hpp"
#include "cli/input_roles.hpp"
#include "cli/run_options.hpp"
#include "cli/steps.hpp"
#include "cli/support/console.hpp"
#include "cli/support/inherited_store.hpp"
#include "cli/support/lengths.hpp"
#include "cli/support/options.hpp"
#include "cli/support/program.hpp"
#include "cli/support/program_json.hpp"
#include "cli/vehicle/vehicle_inputs.hpp"
#include "cli/verdict.hpp"
#include "core/describe/answer.hpp"
#include "core/geometry/point_box.hpp"
#include "core/query/ignored_points.hpp"
#include "core/trajectory/chainage.hpp"
#include "core/util/format.hpp"
#include "core/util/stopwatch.hpp"
#include "findings/touched_first.hpp"
#include "io/files/facts_json.hpp"
#include "io/files/file.hpp"
#include "io/files/pending_file.hpp"
#include "io/files/thread_limit.hpp"
#include "io/result/result_header.hpp"

namespace clearway::tool {
namespace {

/// Watches the resident memory of this process, without mapped files, every few milliseconds from a
/// thread of its own as long as the object lives. Source: /proc/self/statm.
class MemoryWatch {
 public:
  MemoryWatch();
  ~MemoryWatch();
  MemoryWatch(const MemoryWatch&) = delete;
  MemoryWatch& operator=(const MemoryWatch&) = delete;

  /// The largest resident memory that was seen so far, bytes; 0 where the system does not say.
  std::uint64_t peak_bytes();

 private:
  std::uint64_t anonymous_bytes() const;
  void look();

  std::optional<File> statm_;  ///< none where the system does not have it
  std::uint64_t page_bytes_;
  std::atomic<std::uint64_t> peak_{0};
  std::atomic<bool> stopped_{false};
  std::thread thread_;
};

std::uint64_t MemoryWatch::anonymous_bytes() const {
  char text[128] = {};
  if (!statm_ || ::pread(statm_->descriptor(), text, sizeof text - 1, 0) <= 0) return 0;
  unsigned long long total = 0, resident = 0, shared = 0;
  if (std::sscanf(text, "%llu %llu %llu", &total, &resident, &shared) != 3) return 0;
  return resident < shared ? 0 : (resident - shared) * page_bytes_;
}

MemoryWatch::MemoryWatch() : page_bytes_(static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE))) {
  try {
    statm_ = File::open_for_reading("/proc/self/statm");
    thread_ = std::thread([this] {
      while (!stopped_) {
        look();
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
      }
    });
  } catch (const Error&) {
    // The system does not say, so peak_bytes() is 0.
  } catch (const std::system_error&) {
    // No thread is available, so only peak_bytes() reads the memory.
  }
}

MemoryWatch::~MemoryWatch() {
  stopped_ = true;
  if (thread_.joinable()) thread_.join();
}

std::uint64_t MemoryWatch::peak_bytes() {
  look();
  return peak_;
}

void MemoryWatch::look() {
  const std::uint64_t now = anonymous_bytes();
  std::uint64_t peak = peak_;
  while (now > peak && !peak_.compare_exchange_weak(peak, now)) {
  }
}

/// The inputs that were read before, if they are those of the options and in this frame; else those
/// of the files.
RunInputs take_or_read_inputs(RunOptions& options, const EnvironmentFrame& frame) {
  const std::shared_ptr<RunInputs> read = std::move(options.inputs);
  const bool fits = read && read->trajectory == options.trajectory &&
                    read->frame.crs == frame.crs &&
                    read->frame.metres_per_unit == frame.metres_per_unit &&
                    read->frame.unit_is_assumed == frame.unit_is_assumed;
  if (fits) return std::move(*read);
  return read_inputs(options, frame);
}

/// The query of a run. Warnings of the inputs are logged at once, and go into the report with those
/// of the search.
Query read_query(RunOptions& options, const Store& store, PoseLabels& labels) {
  const EnvironmentFrame frame{store.crs_wkt(), store.metres_per_unit(),
                               store.length_unit() == "unknown"};
  RunInputs read = take_or_read_inputs(options, frame);
  std::vector<Message>& warnings = options.search.input_warnings;
  warnings.insert(warnings.end(), read.warnings.begin(), read.warnings.end());
  if (read.name_units && options.lengths.all_have_units()) {
    if (auto note = note_on_feet(store)) warnings.push_back(std::move(*note));
  }
  for (const Message& warning : warnings) log_message(warning);
  labels = std::move(read.labels);
  Query query(std::move(read.query.model), std::move(read.query.poses), options.query);
  query.bodies = std::move(read.query.bodies);
  return query;
}

constexpr const char* kHowToResume =
    "the same command with --resume, without --force, continues from the finished work";

/// Times and memory that the program measures besides what the library reports.
struct ProgramReport {
  double inputs_seconds = 0, total_seconds = 0;  ///< wall clock
  std::uint64_t peak_host_bytes = 0;
};

/// On which side of the vehicle the least distance of the profile is, or without one that of the
/// clearances. Unknown of a vehicle where only the profile has it, which does not know the body.
Side least_side(const SearchReport& report, const Query& query) {
  const auto& profile = report.least_profile;
  const auto& clearance = report.least_clearance;
  const auto& least = profile ? profile : clearance;
  const bool has_body =
      clearance && least->source == clearance->source && least->pose == clearance->pose;
  if (!least || (query.bodies.size() > 1 && !has_body)) return Side::kUnknown;
  const std::vector<MovingBody> bodies = moving_bodies(query);
  const MovingBody& body = bodies[query.bodies.size() > 1 ? clearance->body : 0];
  const Pose* pose = body.pose_at(least->pose);
  if (pose == nullptr || body.model.vertices.empty()) return Side::kUnknown;
  const Vec3 there = ahead_left_up(least->xyz, *pose, Axis::kPlusX, Axis::kPlusZ);
  if (!std::isfinite(there.x) || !std::isfinite(there.y) || !std::isfinite(there.z)) {
    return Side::kUnknown;
  }
  return side_of({there, there}, box_of(body.model.vertices), Axis::kPlusX, Axis::kPlusZ);
}

/// The report as JSON. What only a search knows is null for a result that already existed.
nlohmann::ordered_json json_of(const SearchReport& report, const RunOptions& options,
                               const Query& query, const PathWords& path,
                               const ProgramReport& program) {
  const bool vehicle = !options.vehicle.empty();
  nlohmann::ordered_json out =
      program_json({{"env", options.environment},
                    {vehicle ? "vehicle" : "model", vehicle ? options.vehicle : options.model},
                    {"trajectory", options.trajectory},
                    {"output", options.output}});
  out["radius"] = options.query.radius;
  out["environment_points"] = report.environment_points;
  out["model_as"] = model_as(report.model_solids, report.model_triangles);
  out["model_points"] = report.model_points;
  out["model_solids"] = report.model_solids;
  add_answer(report, path, out);
  const Side side = least_side(report, query);
  out["least_side"] = nullptr;
  if (side != Side::kUnknown) out["least_side"] = name_of(side);
  add_facts(out, report, kFactsOf<SearchReport>);
  if (report.was_finished) {
    for (const char* key : {"engine", "device", "device_name", "searches", "resumed_cells", "pages",
                            "page_bytes", "slots", "needed_host_bytes"}) {
      out[key] = nullptr;
    }
  }
  out["peak_host_bytes"] = program.peak_host_bytes + report.pinned_bytes;
  out["seconds"]["total"] = program.total_seconds;
  out["seconds"]["inputs"] = program.inputs_seconds;
  out["warnings"] = report.warnings;
  return out;
}

void log_report(const SearchReport& report, const RunOptions& options, const std::string& unit,
                double seconds) {
  const std::string output = options.output.string();
  if (report.was_finished) {
    spdlog::info("{}: is the finished result of this query already; nothing to do{}", output,
                 caveat_of(report.warnings.size()));
    return;
  }
  const std::string part = options.search.shard ? in_words(*options.search.shard) + ": " : "";
  const std::string found = part + found_text(report.colliding_points, report.environment_points);
  const std::string how =
      fmt::format("engine {} on {}, {:.2f} s", name_of(report.engine), report.device_name, seconds);
  const bool doubtful = !report.warnings.empty();
  spdlog::info("{}: {}{}", output, doubtful ? "" : found + "; ", how);
  if (options.query.ignores_points()) {
    spdlog::info("{} in the whole environment", ignored_text(options.query, report.ignored));
  }
  if (options.query.clearance > 0) {
    spdlog::info("{} within the clearance of {} {}",
                 counted(report.clearance_points, "point is", "points are"),
                 options.query.clearance, unit);
  }
  if (doubtful) spdlog::info("{}{}", found, caveat_of(report.warnings.size()));
}

Store open_environment(const std::filesystem::path& path) {
  try {
    return open_store(path);
  } catch (const InputError&) {
    check_is_store(path);
    throw;
  }
}

/// Prints the verdict. Where standard output fails, the sentence is logged, because it is the
/// answer, and the command fails.
void print_verdict(const std::string& sentence) {
  try {
    print(sentence + "\n");
  } catch (const ResourceError&) {
    spdlog::info("{}", sentence);
    throw;
  }
}

/// Asks CUDA, before it starts, for enough connections that pages of the grid engine, which take
/// very different times, do not wait for each other.
void prepare_device(const SearchOptions& options) {
  if (options.engine == Engine::kGrid) ::setenv("CUDA_DEVICE_MAX_CONNECTIONS", "32", 0);
}

/// Refuses --fail-on-collision with a shard, because a part without a colliding point does not say
/// that there is none.
void refuse_judging_part(const RunOptions& options) {
  if (!options.search.shard || !options.fail_on_collision) return;
  throw UsageError(
      "--fail-on-collision: one part does not show whether a point collides; clearway merge "
      "--fail-on-collision decides it for all parts");
}

/// What can be said of the places that were not scanned, from the written result.
std::string unseen_sentences(const SearchReport& report, const Query& query,
                             const RunOptions& options, const std::string& unit) {
  if (report.shard || !report.is_not_scanned()) return "";
  ConflictOptions how;
  how.bodies = query.bodies;
  return unseen_text(find_unseen_groups(Result(options.output), query.poses, how), report, unit);
}

}  // namespace

RunInputs read_inputs(RunOptions& options, const EnvironmentFrame& frame) {
  const auto set_unit = [&frame](auto& of_reader) {
    of_reader.environment_unit = frame.metres_per_unit;
    of_reader.environment_unit_is_assumed = frame.unit_is_assumed;
  };
  set_unit(options.model_options);
  set_unit(options.trajectory_options);
  options.trajectory_options.default_crs = frame.crs;
  RunInputs read{frame, options.trajectory, Query({}, {}, {}), {}, {}, false};
  std::vector<Message>& warnings = read.warnings;
  const ModelOptions how = model_options_of(options);
  const bool is_vehicle = !options.vehicle.empty();
  if (!is_vehicle) read.query.model = read_model(options.model, how, &warnings);
  const std::size_t of_model = warnings.size();
  std::vector<Pose>& poses = read.query.poses;
  poses = read_trajectory(options.trajectory, options.trajectory_options, &warnings, &read.labels);
  check_has_poses(poses, options.trajectory);
  const std::span<const Message> said(warnings);
  read.name_units = !is_vehicle && names_unit(how.unit, said.first(of_model)) &&
                    names_unit(options.trajectory_options.metres_per_unit, said.subspan(of_model));
  if (is_vehicle) {
    read.query.bodies =
        read_vehicle(options.vehicle, poses,
                     {how, options.trajectory_options, options.search.threads}, &warnings);
  }
  return read;
}

RunOutcome perform(RunOptions& options) {
  const Stopwatch total;
  MemoryWatch memory;
  ConsoleProgress progress;
  watch_call(options.search, progress);
  if (options.model.empty() && options.vehicle.empty()) throw CLI::RequiredError("--model");
  refuse_judging_part(options);
  std::vector<std::filesystem::path> inputs{options.environment, options.model, options.trajectory};
  if (!options.vehicle.empty()) inputs = vehicle_inputs(options.vehicle, std::move(inputs));
  refuse_overwriting(options.output, inputs);
  if (!options.vehicle.empty()) check_vehicle_search(options.search);
  model_options_of(options);
  check_search(options.query, options.output, options.search);
  options.search.end_gpus = true;
  prepare_device(options.search);
  if (!options.search.started) options.search.started = start_devices(options.search);
  if (options.vehicle.empty()) check_is_model(options.model);
  check_is_trajectory(options.trajectory);
  const Store store = open_environment(options.environment);
  if (!options.search.started) options.search.started = start_devices(options.search, &store);
  if (auto warning = options.lengths.convert_for(store)) {
    options.search.input_warnings.push_back(std::move(*warning));
  }
  PathWords path;
  const Query query =
      in_threads(options.search.threads, [&] { return read_query(options, store, path.labels); });
  path.chainage = chainage_of(query.poses);
  ProgramReport program{.inputs_seconds = total.seconds()};
  SearchReport report = search(store, query, options.output, options.search);
  program.total_seconds = total.seconds();
  log_report(report, options, symbol_of_unit(store.length_unit()), program.total_seconds);
  program.peak_host_bytes = memory.peak_bytes();
  const std::string unit = symbol_of_unit(store.length_unit());
  const std::string sentence =
      verdict_text(report, path, unit, caveat_of(report.warnings.size()), options.names_nearest) +
      unseen_sentences(report, query, options, unit);
  RunOutcome outcome;
  outcome.sentence = sentence;
  if (options.json) outcome.json = json_of(report, options, query, path, program);
  outcome.report = std::move(report);
  return outcome;
}

void add_run(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<RunOptions>();
  CLI::App* command = program.add_subcommand(
      "run", "Find every environment point within the radius of the moving model");
  add_run_options(*command, *options);
  command->footer(
      "A point collides when its distance to the model at some pose is strictly below the radius.\n"
      "A closed mesh is searched as a solid, any other mesh as its surface, and other models as\n"
      "their points. With --between-poses the way from each pose to the next counts too.\n"
      "--between-poses and the engines kdtree and grid search points alone, and refuse a mesh\n"
      "unless --model-as points, --model-spacing or --model-vertices asks for points of it. These\n"
      "engines find the points that collide at the poses, and nothing else.\n"
      "The first pose is the first one that touches the point. With --between-poses it is the "
      "pose\n"
      "from which the first way starts that touches the point. A way includes both its ends.\n"
      "Prints one sentence: clear, conflict or undecided, the first place, and the least distance\n"
      "where --clearance or --profile asks for it. It is undecided where no point collides, but a\n"
      "warning says that none could: nothing was scanned near the path, for example. With\n"
      "--fail-on-collision the exit code is 1 where a point collides, and 6 where it is "
      "undecided.\n"
      "Clearway is exact, at its poses and on the straight ways between them: engine, device,\n"
      "threads and memory do not change the result.\n"
      "Example: clearway run --env site.h5 --model car.ply --trajectory path.txt --radius 0.1 "
      "--first-pose -o out.h5");
  command->callback([options, &exit_code] {
    run_stoppable(options->output, kHowToResume, [&] {
      const RunOutcome outcome = perform(*options);
      if (options->json) {
        spdlog::info("{}", outcome.sentence);
        print(indented_text(outcome.json));
      } else {
        print_verdict(outcome.sentence);
      }
      if (options->fail_on_collision) exit_code = exit_code_of(outcome.report.verdict());
    });
  });
}

}  // namespace clearway::tool
