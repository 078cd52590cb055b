#include <spdlog/spdlog.h>

#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "clearway/commands.hpp"
#include "clearway/console.hpp"
#include "clearway/engines.hpp"
#include "clearway/memory_use.hpp"
#include "clearway/options.hpp"
#include "clearway/standard_output.hpp"
#include "clearway/stopwatch.hpp"
#include "core/error.hpp"
#include "io/content_hash.hpp"
#include "io/model.hpp"
#include "io/pending_file.hpp"
#include "io/store.hpp"
#include "io/trajectory.hpp"
#include "stream/collect.hpp"

namespace clearway::tool {
namespace {

struct Options {
  std::filesystem::path environment, model, trajectory, output;
  double radius = 0;
  EngineOptions engine;
  std::string device = "auto";
  bool first_pose = false;
  double clearance = 0;
  bool between_poses = false;
  TrajectoryOptions trajectory_options;
  bool force = false;
  bool json = false;
};

/// Wall clock of the stages, seconds.
struct Seconds {
  double read = 0, write = 0, total = 0;
};

struct Inputs {
  explicit Inputs(const Options& options)
      : store(options.environment),
        model(read_model(options.model)),
        poses(read_trajectory(options.trajectory, options.trajectory_options)) {}

  Store store;
  std::vector<Vec3> model;
  std::vector<Pose> poses;
};

ResultHeader header_of(const Inputs& inputs, const Options& options) {
  const StoreMetadata& metadata = inputs.store.metadata();
  return {.environment_points = metadata.input_points,
          .environment_hash = metadata.points_hash,
          .model_points = inputs.model.size(),
          .model_hash = hash_of_model(inputs.model),
          .poses = inputs.poses.size(),
          .trajectory_hash = hash_of_trajectory(inputs.poses),
          .radius = options.radius,
          .first_pose = options.first_pose,
          .clearance = options.clearance,
          .between_poses = options.between_poses,
          .quantisation = metadata.quantisation,
          .crs_wkt = metadata.crs_wkt};
}

nlohmann::ordered_json report_of(const Inputs& inputs, const Answer& answer,
                                 const EngineReport& engine, const Seconds& seconds) {
  const Store::Touched touched = inputs.store.touched();
  return {{"environment_points", inputs.store.point_count()},
          {"model_points", inputs.model.size()},
          {"poses", inputs.poses.size()},
          {"colliding_points", answer.hits.count()},
          {"clearance_points", answer.clearances.count()},
          {"engine", engine.engine},
          {"device", "cpu"},
          {"searches", engine.searches},
          {"cells_total", inputs.store.cells().size()},
          {"cells_read", touched.cells},
          {"bytes_read", touched.bytes},
          {"peak_host_bytes", peak_anonymous_bytes()},
          {"peak_device_bytes", 0},
          {"seconds",
           {{"total", seconds.total},
            {"context", 0.0},
            {"plan", engine.plan_seconds},
            {"field", engine.field_seconds},
            {"read", seconds.read},
            {"upload", 0.0},
            {"compute", engine.compute_seconds},
            {"write", seconds.write}}}};
}

void warn_of(const Inputs& inputs) {
  if (inputs.poses.empty()) spdlog::warn("the trajectory has no poses: nothing can collide");
  const LengthUnit unit = inputs.store.metadata().unit;
  if (unit == LengthUnit::kFoot || unit == LengthUnit::kUsSurveyFoot) {
    spdlog::warn("the environment is in feet: radius, model and trajectory are taken in feet too");
  }
}

void run_run(const Options& options) {
  const Stopwatch total;
  refuse_overwriting(options.output, {options.environment, options.model, options.trajectory});
  PendingFile output(options.output, options.force);
  ConsoleProgress progress;
  Seconds seconds;
  const Inputs inputs(options);
  warn_of(inputs);
  const Question question{.model = inputs.model,
                          .poses = inputs.poses,
                          .radius = options.radius,
                          .first_pose = options.first_pose,
                          .between_poses = options.between_poses,
                          .clearance = options.clearance};
  seconds.read = total.seconds();
  EngineReport engine;
  const Answer answer = run_engine(inputs.store, question, options.engine, progress, engine);
  peak_anonymous_bytes();

  const Stopwatch write;
  write_answer(inputs.store, answer, header_of(inputs, options), output.partial(),
               options.engine.memory_bytes - engine.needed_bytes, progress);
  output.publish();
  seconds.write = write.seconds();
  seconds.total = total.seconds();
  spdlog::info("{}: {} of {} environment points collide; engine {} on the CPU, {:.2f} s",
               options.output.string(), format_count(answer.hits.count()),
               format_count(inputs.store.point_count()), engine.engine, seconds.total);
  if (options.clearance > 0) {
    spdlog::info("{} points are closer than {} m", format_count(answer.clearances.count()),
                 options.clearance);
  }
  if (options.json) print(report_of(inputs, answer, engine, seconds).dump(2) + "\n");
}

void add_inputs(CLI::App& command, Options& options) {
  command.add_option("--env", options.environment, "The environment: a store of clearway convert")
      ->type_name("FILE")
      ->required();
  command.add_option("--model", options.model, "The model's points: LAS, PLY or XYZ text, metres")
      ->type_name("FILE")
      ->required();
  command
      .add_option("--trajectory", options.trajectory,
                  "The poses: 12 or 16 numbers a line, TUM, EuRoC or CSV with a header")
      ->type_name("FILE")
      ->required();
  command.add_option("--radius", options.radius, "Search radius in metres, for example 0.1")
      ->type_name("METRES")
      ->required()
      ->check(positive_length());
  command.add_option("-o,--output", options.output, "The result, an HDF5 file")
      ->type_name("FILE")
      ->required();
  const std::map<std::string, TrajectoryFormat> formats{{"auto", TrajectoryFormat::kAuto},
                                                        {"matrix", TrajectoryFormat::kMatrix},
                                                        {"tum", TrajectoryFormat::kTum},
                                                        {"euroc", TrajectoryFormat::kEuroc},
                                                        {"csv", TrajectoryFormat::kCsv}};
  command
      .add_option_function<std::string>(
          "--trajectory-format",
          [formats, &format = options.trajectory_options.format](const std::string& name) {
            format = formats.at(name);
          },
          "Format of the trajectory where a guess could go wrong (default: auto)")
      ->type_name("FORMAT")
      ->check(CLI::IsMember({"auto", "matrix", "tum", "euroc", "csv"}));
  command.add_flag("--allow-non-rigid", options.trajectory_options.allow_non_rigid,
                   "Accept matrices that scale or shear");
}

}  // namespace

void add_run(CLI::App& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand(
      "run", "Find every environment point that the moving model comes closer to than the radius");
  add_inputs(*command, *options);
  command->add_flag("--first-pose", options->first_pose,
                    "Also the first pose (0-based) that touches each colliding point");
  command
      ->add_option("--clearance", options->clearance,
                   "Also distance and pose of the model's nearest approach to every point that it "
                   "comes closer to than this, for example 0.5; engine sweep only")
      ->type_name("METRES")
      ->check(CLI::PositiveNumber);
  command->add_flag("--between-poses", options->between_poses,
                    "Move every model point on a straight segment from each pose to the next");
  command->add_option("--engine", options->engine.engine, "sweep or kdtree; auto takes sweep")
      ->check(CLI::IsMember({"auto", "sweep", "kdtree"}))
      ->capture_default_str();
  command->add_option("--device", options->device, "cpu; auto takes it")
      ->check(CLI::IsMember({"auto", "cpu"}))
      ->capture_default_str();
  add_threads_option(*command, options->engine.threads);
  add_memory_option(*command, options->engine.memory_bytes);
  command
      ->add_option("--field-voxel", options->engine.field_voxel,
                   "Voxel of the sweep engine's model field in metres (default: chosen)")
      ->type_name("METRES")
      ->check(CLI::PositiveNumber);
  command->add_flag("--force", options->force, "Overwrite an existing result");
  command->add_flag("--json", options->json, "Print one JSON object about the run");
  command->footer(
      "A point collides when it is strictly closer than the radius to a model point at a pose,\n"
      "with --between-poses also on the way from a pose to the next. Its first pose is then the "
      "one\n"
      "that the way starts from.\n"
      "The result is the same for every engine, number of threads and memory bound.\n"
      "Example: clearway run --env site.h5 --model car.ply --trajectory path.txt --radius 0.1 "
      "-o out.h5");
  command->callback([options] { run_run(*options); });
}

}  // namespace clearway::tool
