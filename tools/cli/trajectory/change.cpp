#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>

#include "clearway/error.hpp"
#include "clearway/model.hpp"
#include "clearway/smooth.hpp"
#include "clearway/store.hpp"
#include "clearway/trajectory.hpp"
#include "clearway/vehicle.hpp"
#include "cli/steps.hpp"
#include "cli/support/console.hpp"
#include "cli/support/field_options.hpp"
#include "cli/support/lengths.hpp"
#include "cli/support/options.hpp"
#include "cli/support/trajectory_options.hpp"
#include "cli/trajectory/commands.hpp"
#include "cli/trajectory/made_labels.hpp"
#include "cli/vehicle/vehicle_inputs.hpp"
#include "core/describe/smooth.hpp"
#include "core/geometry/point_box.hpp"
#include "core/trajectory/resample_trajectory.hpp"
#include "core/trajectory/trajectory_doubts.hpp"
#include "core/trajectory/trajectory_summary.hpp"
#include "core/util/format.hpp"
#include "io/files/json.hpp"
#include "io/files/pending_file.hpp"
#include "io/models/vehicle_file.hpp"
#include "io/paths/trajectory_file.hpp"

namespace clearway::tool {
namespace {

/// What moves along a path: the box of a model, or those of a vehicle's bodies, each in its own
/// frame and with its own poses.
class Mover {
 public:
  /// poses: the path as it is given. The options outlive this object.
  Mover(const ChangeCommand& options, const std::vector<Pose>& poses);

  bool is_vehicle() const { return !bodies_.empty(); }
  /// The box of the model, or around those of all bodies in their own frames.
  const Box& box() const { return box_; }
  /// The motion_bound() from each pose of a path to the next: of a vehicle, the greatest of those
  /// of its bodies that have both poses.
  std::vector<double> motions(const std::vector<Pose>& path) const;
  double largest_motion(const std::vector<Pose>& path) const {
    const std::vector<double> all = motions(path);
    return all.empty() ? 0 : std::ranges::max(all);
  }

 private:
  struct MovingBox {
    std::string name;
    Box box;
  };

  const ChangeCommand& options_;
  VehicleOptions reading_;
  std::vector<MovingBox> bodies_;  ///< empty for a model
  Box box_{};
};

struct Change {
  std::function<std::vector<Pose>(const std::vector<Pose>& poses, const Mover& mover,
                                  double max_motion, Progress& progress)>
      make;
  const char* consequence;  ///< what missing poses mean for the output
  const char* how;          ///< see made_words()
};

/// How a path was made of another one, for PoseLabels::made_by. how: with places for the name of
/// the given file, its poses and the number of the new ones
std::string made_words(const std::string& how, const std::filesystem::path& given,
                       std::size_t before, std::size_t after) {
  if (before == 0) return "";
  std::string name = given.filename().string();
  std::ranges::replace_if(
      name, [](unsigned char c) { return c < ' '; }, ' ');
  const std::string poses = counted(before, "given pose"), now = format_count(after);
  return fmt::format(fmt::runtime(how), name, poses, now);
}

std::vector<Pose> resample(const std::vector<Pose>& poses, const Mover& mover, double max_motion,
                           Progress& progress) {
  std::vector<Pose> path = resample_trajectory(poses, mover.box(), max_motion, progress);
  // A body may turn where the path's own pose goes straight on, so that steps that are small
  // enough for the path are not for the body.
  constexpr double kRounding = 1e-9, kLess = 0.98;
  constexpr int kMostTries = 16;
  double step = max_motion;
  for (int i = 0; mover.is_vehicle() && i < kMostTries; ++i) {
    const double largest = mover.largest_motion(path);
    if (largest <= max_motion * (1 + kRounding)) break;
    step *= kLess * max_motion / largest;
    path = resample_trajectory(poses, mover.box(), step, progress);
  }
  return path;
}

std::vector<Pose> thin(const std::vector<Pose>& poses, const Mover& mover, double max_motion,
                       Progress&) {
  if (mover.is_vehicle()) {
    throw InputError("is thinned for one model, and a vehicle of several bodies is given");
  }
  std::vector<Pose> kept;
  for (const std::size_t i : thin_trajectory(poses, mover.box(), max_motion)) {
    kept.push_back(poses[i]);
  }
  return kept;
}

std::vector<Pose> changed(const std::vector<Pose>& poses, const Mover& mover,
                          const ChangeCommand& options, const Change& change, Progress& progress) {
  try {
    return change.make(poses, mover, options.max_motion, progress);
  } catch (const InputError& error) {
    throw InputError(options.input.string() + ": " + error.what());
  }
}

/// How models are read: no other place of a mesh is farther out than its vertices.
ModelOptions reading_of_models(const ChangeCommand& options) {
  return {.unit = options.model_unit,
          .environment_unit = options.trajectory.environment_unit,
          .forward = options.model_axes.forward,
          .up = options.model_axes.up,
          .vertices_only = true};
}

/// The bounding box of the model.
Box box_of_model(const ChangeCommand& options) {
  return box_of(read_model_points(options.model, reading_of_models(options)));
}

std::vector<double> motions_of(const std::vector<Pose>& poses, const Box& model) {
  std::vector<double> motions;
  for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
    motions.push_back(motion_bound(model, poses[i], poses[i + 1]));
  }
  return motions;
}

Mover::Mover(const ChangeCommand& options, const std::vector<Pose>& poses) : options_(options) {
  if (!names_vehicle(options.model)) {
    box_ = box_of_model(options);
    return;
  }
  reading_ = {.model = reading_of_models(options), .trajectory = options.trajectory};
  for (const BodyEntry& entry :
       read_vehicle_file(options.model, options.trajectory.environment_unit)) {
    if (entry.trajectory.empty()) continue;
    throw InputError(options.model.string() + ": the poses of the body " + entry.name +
                     " belong to those of the path one by one, so the path has to keep its own");
  }
  std::optional<Box> all;
  for (const Body& body : read_vehicle(options.model, poses, reading_)) {
    bodies_.push_back({body.name, box_of(body.model.vertices)});
    all = all ? all->united(bodies_.back().box) : bodies_.back().box;
  }
  box_ = all.value_or(Box{});
}

std::vector<double> Mover::motions(const std::vector<Pose>& path) const {
  if (!is_vehicle()) return motions_of(path, box_);
  std::vector<double> motions(path.empty() ? 0 : path.size() - 1, 0.0);
  FollowedPath unused;
  for (const auto& [name, box] : bodies_) {
    const Body body = place_body(options_.model, name, path, reading_, nullptr, unused);
    for (std::size_t i = 0; i + 1 < body.poses.size(); ++i) {
      const std::uint32_t at = body.path_pose[i];
      if (body.path_pose[i + 1] != at + 1) continue;
      motions[at] = std::max(motions[at], motion_bound(box, body.poses[i], body.poses[i + 1]));
    }
  }
  return motions;
}

/// Warns of gaps in the recording, which can no longer be seen in the output.
void warn_of_jumps(const std::vector<double>& motions, const ChangeCommand& options,
                   const std::string& consequence) {
  const auto jumps = jumps_of(motions, std::min(kLeastJump, options.max_motion));
  if (jumps.empty()) return;
  log_message(jump_warning(jumps, options.input.string() + ": as the model moves, ", options.unit,
                           consequence));
}

/// Takes the store's unit for lengths and for files without a unit of their own.
void take_unit_of_environment(ChangeCommand& options) {
  if (options.environment.empty()) return;
  const Store store(options.environment);
  if (const auto warning = options.lengths.convert_for(store)) log_message(*warning);
  set_environment_unit(store, options.trajectory);
  options.trajectory.default_crs = store.crs_wkt();
  options.unit = symbol_of_unit(store.length_unit());
}

/// Reads the path, and logs what is odd about it and which labels are left out.
TrajectoryFile read_path(const ChangeCommand& options) {
  TrajectoryFile path = read_trajectory_file(options.input, options.trajectory);
  for (const Message& remark : path.remarks) log_message(remark);
  tell_of_labels(options.input, path.labels);
  return path;
}

void refuse_overwriting_inputs(const ChangeCommand& options) {
  std::vector<std::filesystem::path> inputs{options.input};
  if (names_vehicle(options.model)) {
    inputs = vehicle_inputs(options.model, std::move(inputs));
  } else if (!options.model.empty()) {
    inputs.push_back(options.model);
  }
  if (!options.environment.empty()) inputs.push_back(options.environment);
  refuse_overwriting(options.output, inputs);
}

void write_changed(ChangeCommand& options, const Change& change) {
  refuse_overwriting_inputs(options);
  take_unit_of_environment(options);
  PendingFile output(options.output, options.force);
  const TrajectoryFile path = read_path(options);
  const std::vector<Pose>& before = path.poses;
  if (before.empty()) spdlog::warn("{}: no poses", options.input.string());
  const Mover mover(options, before);
  const std::vector<double> motions_before = mover.motions(before);
  const double motion_before = motions_before.empty() ? 0 : std::ranges::max(motions_before);
  if (!std::isfinite(motion_before)) {
    throw InputError(options.input.string() +
                     ": poses too far apart: the motion from one to the next is no finite number");
  }
  warn_of_jumps(motions_before, options, change.consequence);
  ConsoleProgress progress;
  const std::vector<Pose> after = changed(before, mover, options, change, progress);
  PoseLabels labels = labels_along(before, path.labels, after);
  labels.made_by = made_words(change.how, options.input, before.size(), after.size());
  write_poses(after, labels, path, output.partial(), progress);
  output.publish();

  const double motion_after = mover.largest_motion(after);
  spdlog::info("{}: {}, from {}; the largest motion from one to the next {:.6g} {}, was {:.6g} {}",
               options.output.string(), counted(after.size(), "pose"), format_count(before.size()),
               motion_after, options.unit, motion_before, options.unit);
  if (options.json) {
    const nlohmann::ordered_json report{{"poses_in", before.size()},
                                        {"poses_out", after.size()},
                                        {"max_motion", options.max_motion},
                                        {"largest_motion_before", motion_before},
                                        {"largest_motion_after", motion_after}};
    print(indented_text(report));
  }
}

/// Adds the options that all changes of a path have but for how much it is changed. Returns that of
/// the model.
CLI::Option* add_files(CLI::App& command, ChangeCommand& options) {
  add_file(command, "IN", options.input, kTrajectoryHelp)->required();
  add_file(command, "-o,--output", options.output,
           "The new trajectory: a table with the unit and the stations of the path or, where "
           "it names neither, 16 numbers a line, a row-major 4x4 matrix")
      ->required();
  CLI::Option* model =
      add_file(command, "--model", options.model,
               "The model, as clearway run reads it, or the file of a vehicle of several "
               "bodies; their bounding boxes are what moves");
  add_file(command, "--env", options.environment,
           "The store: says the unit of lengths, and which foot a ft is, and gives the CRS");
  return model;
}

void add_reading(CLI::App& command, ChangeCommand& options) {
  add_model_unit(command, options.model_unit);
  add_turn_options(command, options.model_axes.forward, options.model_axes.up);
  add_trajectory_options(command, options.trajectory, options.lengths);
  command.add_flag("--force", options.force, "Overwrite an existing output");
  command.add_flag("--json", options.json, "One JSON object on standard output");
}

void add_change_options(CLI::App& command, ChangeCommand& options, const char* max_motion_help) {
  CLI::Option* model = add_files(command, options);
  options.lengths.add(command, "--max-motion", options.max_motion, max_motion_help)->required();
  model->required();
  add_reading(command, options);
}

void add_change(CLI::App& command, const char* max_motion_help, const Change& change) {
  const auto options = std::make_shared<ChangeCommand>();
  add_change_options(command, *options, max_motion_help);
  command.callback([options, change] {
    run_stoppable(options->output, kStartsAgain, [&] { write_changed(*options, change); });
  });
}

struct SmoothCommand : ChangeCommand {
  SmoothParameters parameters;
};

/// A length in tenths of a millimetre, or of a thousandth of another unit, rounded up so that it
/// remains a bound.
double rounded_up(double length) {
  const double tenths = std::ceil(length * 1e4 - 1e-9);
  return tenths / 1e4 >= length ? tenths / 1e4 : (tenths + 1) / 1e4;
}

SmoothPath smoothed(const std::vector<Pose>& poses, const SmoothCommand& options) {
  ConsoleProgress progress;
  const std::optional<Box> model =
      options.model.empty() ? std::nullopt : std::optional(box_of_model(options));
  try {
    return smooth_trajectory(
        poses, options.parameters, model,
        [&](const ProgressUpdate& update) { progress.update(update); }, &stop_flag());
  } catch (const InputError& error) {
    throw InputError(options.input.string() + ": " + error.what());
  } catch (const UsageError& error) {
    throw UsageError(options.input.string() + ": " + error.what());
  }
}

/// The labels of new poses, linear between those of the given ones.
PoseLabels labels_at(const std::vector<double>& places, const PoseLabels& labels) {
  return made_labels(labels, [&](const std::vector<double>& values) {
    std::vector<double> out;
    for (const double place : places) {
      const auto i = static_cast<std::size_t>(place);
      const double part = place - static_cast<double>(i);
      out.push_back(part > 0 ? values[i] + part * (values[i + 1] - values[i]) : values[i]);
    }
    return out;
  });
}

void write_smoothed(SmoothCommand& options) {
  refuse_overwriting_inputs(options);
  take_unit_of_environment(options);
  if (options.parameters.step == 0) {
    options.parameters.step = 0.1 / options.trajectory.environment_unit;
  }
  PendingFile output(options.output, options.force);
  const TrajectoryFile given = read_path(options);
  const std::vector<Pose>& before = given.poses;
  const SmoothPath path = smoothed(before, options);
  ConsoleProgress progress;
  PoseLabels labels = labels_at(path.place, given.labels);
  labels.made_by =
      made_words("smooth of {}: {}, {} in their place on a smooth curve within " +
                     format_brief(options.parameters.within) + " " + options.unit + " of them",
                 options.input, before.size(), path.poses.size());
  write_poses(path.poses, labels, given, output.partial(), progress);
  output.publish();
  const std::string& unit = options.unit;
  const double at_poses = rounded_up(path.error_at_poses());
  const double between_poses = rounded_up(path.error_between_poses());
  const std::string sentence = fmt::format(
      "{} on a curve of {}, from {}; the largest deviation is {:.4f} {}, the mean {:.4f} {}. "
      "--error-model {:.4f} covers the given path, with --between-poses {:.4f}",
      counted(path.poses.size(), "pose"), counted(path.control_points, "control point"),
      format_count(before.size()), between_poses, unit, path.mean_deviation, unit, at_poses,
      between_poses);
  if (!options.json) return print(sentence + "\n");
  spdlog::info("{}: {}", options.output.string(), sentence);
  print(indented_text(nlohmann::ordered_json{{"poses_in", before.size()},
                                             {"poses_out", path.poses.size()},
                                             {"control_points", path.control_points},
                                             {"within", options.parameters.within},
                                             {"step", options.parameters.step},
                                             {"largest_deviation", path.largest_deviation},
                                             {"mean_deviation", path.mean_deviation},
                                             {"largest_step", path.largest_step},
                                             {"error_model", at_poses},
                                             {"error_model_between_poses", between_poses}}));
}

void add_smooth(CLI::App& trajectory) {
  const auto options = std::make_shared<SmoothCommand>();
  CLI::App* command = trajectory.add_subcommand(
      "smooth", "Put a smooth curve to a noisy path, and say which error covers the difference");
  add_files(*command, *options);
  add_required_fields(*command, kSmoothFields, options->parameters, options->lengths);
  add_fields(*command, kSmoothFields, options->parameters, options->lengths);
  add_reading(*command, *options);
  command->footer(
      "The model is required where rotations change. Without one, --within and --step hold for\n"
      "the positions.\n"
      "Example: clearway trajectory smooth path.txt -o smooth.txt --within 0.01 --model car.ply");
  command->callback([options] {
    run_stoppable(options->output, kStartsAgain, [&] { write_smoothed(*options); });
  });
}

constexpr const char* kResampleMotion =
    "The most that a model point may move from one pose to the next";
const Change kResample{resample, ". The poses that are put between them are a guess",
                       "resample of {}: {} among {}, the others on a smooth curve through them"};

}  // namespace

void add_options(CLI::App& command, ChangeCommand& options) {
  add_change_options(command, options, kResampleMotion);
}

void perform(ChangeCommand& options) { write_changed(options, kResample); }

double motion_to_fill(ChangeCommand& options) {
  constexpr double kRounding = 1e-6, kMostPoses = 1e6;
  take_unit_of_environment(options);
  const std::vector<Pose> poses = read_trajectory(options.input, options.trajectory);
  const std::vector<double> motions = Mover(options, poses).motions(poses);
  if (motions.empty()) return 0;
  const double largest = std::ranges::max(motions), most = options.max_motion;
  const double needed = std::accumulate(motions.begin(), motions.end(), 0.0) / most;
  const bool has_jumps = !jumps_of(motions, std::min(kLeastJump, most)).empty();
  return largest > most * (1 + kRounding) && needed < kMostPoses && !has_jumps ? largest : 0;
}

void add_trajectory_changes(CLI::App& trajectory) {
  CLI::App* resampling = trajectory.add_subcommand(
      "resample", "Add poses on a smooth curve until all steps are small; the given poses stay");
  add_change(*resampling, kResampleMotion, kResample);
  resampling->footer(
      "Example: clearway trajectory resample path.txt -o dense.txt --max-motion 0.05 --model "
      "car.ply");
  CLI::App* thinning =
      trajectory.add_subcommand("thin", "Leave out poses; each one left out is near a kept one");
  add_change(
      *thinning,
      "The most that a model point may move between a dropped pose and the last kept pose before "
      "it",
      {thin, ". The output does not show it any more", "thin of {}: {}, of which {} are left"});
  thinning->footer(
      "Example: clearway trajectory thin path.txt -o sparse.txt --max-motion 0.01 --model car.ply");
  add_smooth(trajectory);
}

}  // namespace clearway::tool
