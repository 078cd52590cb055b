#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/commands.hpp"
#include "cli/console.hpp"
#include "cli/memory_use.hpp"
#include "cli/options.hpp"
#include "cli/run_journal.hpp"
#include "cli/run_options.hpp"
#include "cli/signals.hpp"
#include "cli/standard_output.hpp"
#include "core/util/format.hpp"
#include "core/util/stopwatch.hpp"
#include "io/formats/model.hpp"
#include "io/store/store_reader.hpp"
#include "io/system/pending_file.hpp"
#include "io/trajectory/content_hash.hpp"
#include "search/engines.hpp"
#include "stream/write_result.hpp"

namespace clearway::tool {
namespace {

/// Wall clock of what the engine does not report itself, seconds.
struct Seconds {
  double inputs = 0, write = 0, total = 0;
};

constexpr const char* kHowToResume =
    "the same command with --resume, without --force, continues it";

struct Inputs {
  explicit Inputs(const RunOptions& options)
      : store(options.environment),
        model(read_model(options.model, &model_info)),
        poses(read_trajectory(options.trajectory, options.trajectory_options)) {}

  StoreReader store;
  CloudInfo model_info;
  std::vector<Vec3> model;
  std::vector<Pose> poses;
};

ResultHeader header_of(const Inputs& inputs, const RunOptions& options) {
  const StoreMetadata& metadata = inputs.store.metadata();
  return {options.query,
          metadata.input_points,
          metadata.points_hash,
          inputs.model.size(),
          hash_of_model(inputs.model),
          inputs.poses.size(),
          hash_of_trajectory(inputs.poses),
          options.query.tolerance > 0 ? chosen_engine(options.engine) : "",
          options.engine.float_precision,
          metadata.quantisation,
          metadata.crs_wkt};
}

nlohmann::ordered_json seconds_of(const EngineReport& engine, const Seconds& seconds) {
  return {{"total", seconds.total},
          {"inputs", seconds.inputs},
          {"context", engine.context_seconds},
          {"thin", engine.tolerance ? engine.tolerance->thin_seconds : 0},
          {"plan", engine.plan_seconds},
          {"field", engine.field_seconds},
          {"engine", engine.engine_seconds},
          {"search", engine.stages.total},
          {"read", engine.stages.read},
          {"upload", engine.stages.upload},
          {"compute", engine.stages.compute},
          {"collect", engine.stages.collect},
          {"write", seconds.write}};
}

/// What the tolerance spared; null for an exact answer.
nlohmann::ordered_json tolerance_of(const Inputs& inputs, const RunOptions& options,
                                    const EngineReport& engine) {
  if (!engine.tolerance) return nullptr;
  const ToleranceReport& spared = *engine.tolerance;
  return {{"metres", options.query.tolerance},
          {"model_points", inputs.model.size()},
          {"model_points_kept", spared.model_points_kept},
          {"poses", inputs.poses.size()},
          {"poses_kept", spared.poses_kept},
          {"searches_saved", engine.searches - spared.model_points_kept * spared.poses_kept},
          {"settled_by_bounds", spared.resolved_by_bounds}};
}

nlohmann::ordered_json report_of(const Inputs& inputs, const RunOptions& options,
                                 const SearchResult& answer, const EngineReport& engine,
                                 std::uint64_t peak_host_bytes, const Seconds& seconds) {
  const StoreReader::Touched touched = inputs.store.touched();
  return {{"environment_points", inputs.store.point_count()},
          {"model_points", inputs.model.size()},
          {"poses", inputs.poses.size()},
          {"colliding_points", answer.hits.count()},
          {"clearance_points", answer.clearances.count()},
          {"engine", engine.engine},
          {"device", engine.device},
          {"searches", engine.searches},
          {"field_voxel", engine.field_voxel},
          {"grid_cell", engine.grid_cell},
          {"cells_total", inputs.store.cells().size()},
          {"cells_read", touched.cells},
          {"bytes_read", touched.bytes},
          {"resumed_cells", engine.resumed_cells},
          {"resumed_poses", engine.resumed_poses},
          {"pages", engine.pages},
          {"page_bytes", engine.page_bytes},
          {"slots", engine.slots},
          {"needed_host_bytes", engine.needed_bytes},
          {"peak_host_bytes", peak_host_bytes},
          {"peak_device_bytes", engine.peak_device_bytes},
          {"tolerance", tolerance_of(inputs, options, engine)},
          {"seconds", seconds_of(engine, seconds)}};
}

/// Of an answer that was there already: no engine searched.
nlohmann::ordered_json report_of(const ResultReader& result, const Inputs& inputs,
                                 std::uint64_t peak_host_bytes, const Seconds& seconds) {
  const ResultHeader& header = result.header();
  return {{"environment_points", header.environment_points},
          {"model_points", header.model_points},
          {"poses", header.poses},
          {"colliding_points", result.collisions()},
          {"clearance_points", result.clearances()},
          {"engine", nullptr},
          {"device", nullptr},
          {"cells_total", inputs.store.cells().size()},
          {"cells_read", 0},
          {"bytes_read", 0},
          {"peak_host_bytes", peak_host_bytes},
          {"peak_device_bytes", 0},
          {"seconds", seconds_of(EngineReport(), seconds)}};
}

void warn_of(const Inputs& inputs, const RunOptions& options) {
  if (inputs.model_info.faces > 0) {
    spdlog::warn(
        "{}: its {} faces are not read: the model is its {} points; sample the surface where "
        "they are farther apart than the radius",
        options.model.string(), format_count(inputs.model_info.faces),
        format_count(inputs.model.size()));
  }
  if (inputs.poses.empty()) spdlog::warn("the trajectory has no poses: nothing can collide");
  const LengthUnit unit = inputs.store.metadata().unit;
  if (unit == LengthUnit::kFoot || unit == LengthUnit::kUsSurveyFoot) {
    spdlog::warn("the environment is in feet: radius, model and trajectory are taken in feet too");
  }
}

/// "auto" goes on where the run that is resumed was.
EngineOptions engine_options(const RunOptions& options, const RunJournal& journal) {
  EngineOptions engine = options.engine;
  const std::string earlier = journal.earlier_device();
  if (engine.device != "auto" || !engine.gpus.empty() || earlier.empty()) return engine;
  engine.device = earlier;
  if (earlier == "cpu") engine.device_memory_bytes = 0;
  return engine;
}

void run(const RunOptions& options) {
  const Stopwatch total;
  MemoryWatch memory;
  check_query(Query({}, {}, options.query), options.engine);
  refuse_overwriting(options.output, {options.environment, options.model, options.trajectory});
  PendingFile output(options.output, true);
  RunJournal journal(output, options);
  if (!options.force && !options.resume) output.refuse_existing();
  ConsoleProgress progress;
  Seconds seconds;
  const Inputs inputs(options);
  warn_of(inputs, options);
  const ResultHeader header = header_of(inputs, options);
  if (journal.already_done(inputs.store, header, progress)) {
    spdlog::info("{}: is the finished result of this query already; nothing to do",
                 options.output.string());
    seconds.inputs = seconds.total = total.seconds();
    if (options.json) {
      const ResultReader result(options.output);
      print(report_of(result, inputs, memory.peak_bytes(), seconds).dump(2) + "\n");
    }
    return;
  }
  const Query query(inputs.model, inputs.poses, options.query);
  seconds.inputs = total.seconds();
  EngineReport engine;
  throw_if_stopped(progress);
  const auto open_journal = [&](const std::string& name,
                                const std::string& device) -> SearchJournal& {
    return journal.open(inputs.store, query, header, name, device);
  };
  const SearchResult answer = run_engine(inputs.store, query, engine_options(options, journal),
                                         open_journal, progress, engine);

  engine.resumed_cells = journal.earlier().cells;
  engine.resumed_poses = journal.earlier().poses;

  const Stopwatch write;
  try {
    write_result(inputs.store, answer, header, output.partial(), engine.write_bytes, progress);
    output.publish();
  } catch (const ResourceError& error) {
    throw ResourceError(std::string(error.what()) + "; " + kHowToResume);
  }
  journal.remove_after_publication();
  seconds.write = write.seconds();
  seconds.total = total.seconds();
  spdlog::info("{}: {} of {} environment points collide; engine {} on {}, {:.2f} s",
               options.output.string(), format_count(answer.hits.count()),
               format_count(inputs.store.point_count()), engine.engine, engine.device_name,
               seconds.total);
  if (options.query.clearance > 0) {
    spdlog::info("{} points have a clearance below {} m", format_count(answer.clearances.count()),
                 options.query.clearance);
  }
  if (options.json) {
    const std::uint64_t peak = memory.peak_bytes() + engine.pinned_bytes;
    print(report_of(inputs, options, answer, engine, peak, seconds).dump(2) + "\n");
  }
}

}  // namespace

void add_run(CLI::App& program) {
  auto options = std::make_shared<RunOptions>();
  CLI::App* command = program.add_subcommand(
      "run", "Find every environment point within the radius of the moving model");
  add_run_options(*command, *options);
  command->footer(
      "A point collides when its distance to a model point at some pose is strictly below the\n"
      "radius. With --between-poses the way from each pose to the next counts too, for the pose\n"
      "that it starts from.\n"
      "Engine, device, threads and memory do not change the result. With --tolerance the device\n"
      "and --field-voxel do.\n"
      "Example: clearway run --env site.h5 --model car.ply --trajectory path.txt --radius 0.1 -o "
      "out.h5");
  command->callback(
      [options] { run_stoppable(options->output, kHowToResume, [&] { run(*options); }); });
}

}  // namespace clearway::tool
