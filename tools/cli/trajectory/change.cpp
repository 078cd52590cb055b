#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "clearway/error.hpp"
#include "clearway/model.hpp"
#include "clearway/smooth.hpp"
#include "clearway/trajectory.hpp"
#include "clearway/vehicle.hpp"
#include "cli/support/field_options.hpp"
#include "cli/support/trajectory_options.hpp"
#include "cli/trajectory/commands.hpp"
#include "cli/vehicle/vehicle_inputs.hpp"
#include "core/describe/smooth.hpp"
#include "core/geometry/point_box.hpp"
#include "core/trajectory/chainage.hpp"
#include "core/trajectory/resample_trajectory.hpp"
#include "core/trajectory/trajectory_doubts.hpp"
#include "core/trajectory/trajectory_summary.hpp"
#include "core/util/format.hpp"
#include "io/files/json.hpp"
#include "io/models/vehicle_file.hpp"

namespace clearway::tool {
namespace {

/// The greatest of lengths; 0 where there are none.
double greatest_of(const std::vector<double>& lengths) {
  return lengths.empty() ? 0 : std::ranges::max(lengths);
}

/// How models are read: no other place of a mesh is farther out than its vertices.
ModelOptions reading_of_models(const ChangeCommand& options) {
  return {.unit = options.model_unit,
          .environment_unit = options.trajectory.environment_unit,
          .forward = options.model_axes.forward,
          .up = options.model_axes.up,
          .vertices_only = true};
}

/// What moves along a path: the box of a model, or those of a vehicle's bodies, each in its own
/// frame and with its own poses.
class Mover {
 public:
  /// poses: the path as it is given. The options outlive this object.
  Mover(const ChangeCommand& options, const std::vector<Pose>& poses) : options_(options) {
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
    for (const Body& body : read_vehicle(options.model, poses, reading_)) {
      const Box box = box_of(body.model.vertices);
      box_ = is_vehicle() ? box_.united(box) : box;
      bodies_.emplace_back(body.name, box);
    }
  }

  bool is_vehicle() const { return !bodies_.empty(); }
  /// The box of the model, or around those of all bodies in their own frames.
  const Box& box() const { return box_; }

  /// The motion_bound() from each pose of a path to the next: of a vehicle, the greatest of those
  /// of its bodies that have both poses.
  std::vector<double> motions(const std::vector<Pose>& path) const {
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

 private:
  const ChangeCommand& options_;
  VehicleOptions reading_;
  std::vector<std::pair<std::string, Box>> bodies_;  ///< empty for a model
  Box box_{};
};

struct Changed {
  std::vector<Pose> poses;
  PoseLabels labels;
};

struct Change {
  std::function<Changed(const TrajectoryFile& path, const Mover& mover, double max_motion,
                        Progress& progress)>
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

/// The labels of a path to which poses were added. Those get values between those of their
/// neighbours, linear in the way along `after`.
PoseLabels labels_between(const TrajectoryFile& before, const std::vector<Pose>& after) {
  const std::vector<double> way = chainage_of(after);
  std::vector<std::size_t> given;  // where the given poses are among those of `after`
  std::vector<double> way_of_given;
  for (std::size_t k = 0; k < after.size() && given.size() < before.poses.size(); ++k) {
    if (after[k] != before.poses[given.size()]) continue;
    given.push_back(k);
    way_of_given.push_back(way[k]);
  }
  return made_labels(before.labels, [&](const std::vector<double>& values) {
    std::vector<double> out;
    for (const double at : way) out.push_back(value_at(way_of_given, values, at));
    for (std::size_t i = 0; i < given.size(); ++i) out[given[i]] = values[i];
    return out;
  });
}

Changed resample(const TrajectoryFile& path, const Mover& mover, double max_motion,
                 Progress& progress) {
  std::vector<Pose> poses = resample_trajectory(path.poses, mover.box(), max_motion, progress);
  // A body may turn where the path's own pose goes straight on, so that steps that are small
  // enough for the path are not for the body.
  constexpr double kRounding = 1e-9, kLess = 0.98;
  constexpr int kMostTries = 16;
  double step = max_motion;
  for (int i = 0; mover.is_vehicle() && i < kMostTries; ++i) {
    const double largest = greatest_of(mover.motions(poses));
    if (largest <= max_motion * (1 + kRounding)) break;
    step *= kLess * max_motion / largest;
    poses = resample_trajectory(path.poses, mover.box(), step, progress);
  }
  PoseLabels labels = labels_between(path, poses);
  return {std::move(poses), std::move(labels)};
}

Changed thin(const TrajectoryFile& path, const Mover& mover, double max_motion, Progress&) {
  if (mover.is_vehicle()) {
    throw InputError("is thinned for one model, and a vehicle of several bodies is given");
  }
  Changed kept;
  std::vector<double> places;
  for (const std::size_t i : thin_trajectory(path.poses, mover.box(), max_motion)) {
    kept.poses.push_back(path.poses[i]);
    places.push_back(static_cast<double>(i));
  }
  kept.labels = labels_at(places, path.labels);
  return kept;
}

/// Refuses an output that is an input, and takes the unit of the store.
void prepare(ChangeCommand& options) {
  if (names_vehicle(options.model)) {
    refuse_overwriting_inputs(options, vehicle_inputs(options.model, {}));
  } else {
    refuse_overwriting_inputs(options, {options.model});
  }
  take_environment(options);
}

void write_changed(ChangeCommand& options, const Change& change) {
  prepare(options);
  write_output(options, [&](const std::filesystem::path& file) {
    const TrajectoryFile path = read_path(options);
    const std::vector<Pose>& before = path.poses;
    if (before.empty()) spdlog::warn("{}: no poses", options.input.string());
    const Mover mover(options, before);
    const std::vector<double> motions = mover.motions(before);
    const double motion_before = greatest_of(motions);
    if (!std::isfinite(motion_before)) {
      throw InputError(
          options.input.string() +
          ": poses too far apart: the motion from one to the next is no finite number");
    }
    // The output does not show any more where poses are missing in the recording.
    if (const auto jumps = jumps_of(motions, std::min(kLeastJump, options.max_motion));
        !jumps.empty()) {
      log_message(jump_warning(jumps, options.input.string() + ": as the model moves, ",
                               options.unit, change.consequence));
    }
    ConsoleProgress progress;
    auto [after, labels] =
        on_path(options, [&] { return change.make(path, mover, options.max_motion, progress); });
    labels.made_by = made_words(change.how, options.input, before.size(), after.size());
    write_poses(after, labels, path, file);
    const double motion_after = greatest_of(mover.motions(after));
    return WrittenPoses{
        fmt::format("{}, from {}; the largest motion from one to the next {:.6g} {}, was {:.6g} {}",
                    counted(after.size(), "pose"), format_count(before.size()), motion_after,
                    options.unit, motion_before, options.unit),
        {{"poses_in", before.size()},
         {"poses_out", after.size()},
         {"max_motion", options.max_motion},
         {"largest_motion_before", motion_before},
         {"largest_motion_after", motion_after}}};
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
    return on_path(options, [&] {
      return smooth_trajectory(
          poses, options.parameters, model,
          [&](const ProgressUpdate& update) { progress.update(update); }, &stop_flag());
    });
  } catch (const UsageError& error) {
    throw UsageError(options.input.string() + ": " + error.what());
  }
}

void write_smoothed(SmoothCommand& options) {
  prepare(options);
  double& step = options.parameters.step;
  if (step == 0) step = 0.1 / options.trajectory.environment_unit;
  write_output(options, [&](const std::filesystem::path& file) {
    const TrajectoryFile given = read_path(options);
    const std::size_t before = given.poses.size();
    const std::string& unit = options.unit;
    const SmoothPath path = smoothed(given.poses, options);
    PoseLabels labels = labels_at(path.place, given.labels);
    labels.made_by =
        made_words("smooth of {}: {}, {} in their place on a smooth curve within " +
                       format_brief(options.parameters.within) + " " + unit + " of them",
                   options.input, before, path.poses.size());
    write_poses(path.poses, labels, given, file);
    const double at_poses = rounded_up(path.error_at_poses());
    const double between_poses = rounded_up(path.error_between_poses());
    return WrittenPoses{
        fmt::format("{} on a curve of {}, from {}; the largest deviation is {:.4f} {}, the mean "
                    "{:.4f} {}. --error-model {:.4f} covers the given path, with --between-poses "
                    "{:.4f}",
                    counted(path.poses.size(), "pose"),
                    counted(path.control_points, "control point"), format_count(before),
                    between_poses, unit, path.mean_deviation, unit, at_poses, between_poses),
        {{"poses_in", before},
         {"poses_out", path.poses.size()},
         {"control_points", path.control_points},
         {"within", options.parameters.within},
         {"step", step},
         {"largest_deviation", path.largest_deviation},
         {"mean_deviation", path.mean_deviation},
         {"largest_step", path.largest_step},
         {"error_model", at_poses},
         {"error_model_between_poses", between_poses}},
        true};
  });
}

/// Adds the options that all changes of a path have. add_bound: adds those that say how much it is
/// changed.
void add_own_options(CLI::App& command, ChangeCommand& options,
                     const std::function<void()>& add_bound) {
  add_file(command, "--model", options.model,
           "The model, as clearway run reads it, or the file of a vehicle of several "
           "bodies; their bounding boxes are what moves");
  add_file(command, "--env", options.environment,
           "The store: says the unit of lengths, and which foot a ft is, and gives the CRS");
  add_bound();
  add_model_unit(command, options.model_unit);
  add_turn_options(command, options.model_axes.forward, options.model_axes.up);
  add_trajectory_options(command, options.trajectory, options.lengths);
}

/// The options of a change that needs a model. help: that of --max-motion.
auto options_with_motion(const char* help) {
  return [help](CLI::App& command, ChangeCommand& options) {
    add_own_options(command, options, [&] {
      options.lengths.add(command, "--max-motion", options.max_motion, help)->required();
    });
    command.get_option("--model")->required();
  };
}

constexpr const char* kNewTrajectory =
    "The new trajectory: a table with the unit and the stations of the path or, where it names "
    "neither, 16 numbers a line, a row-major 4x4 matrix";

const auto kAddResampleOptions =
    options_with_motion("The most that a model point may move from one pose to the next");

}  // namespace

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

void add_options(CLI::App& command, ChangeCommand& options) {
  add_pose_options(command, options, kTrajectoryHelp, kNewTrajectory,
                   [&] { kAddResampleOptions(command, options); });
}

void perform(ChangeCommand& options) {
  write_changed(options,
                {resample, ". The poses that are put between them are a guess",
                 "resample of {}: {} among {}, the others on a smooth curve through them"});
}

double motion_to_fill(ChangeCommand& options) {
  constexpr double kRounding = 1e-6, kMostPoses = 1e6;
  take_environment(options);
  const std::vector<Pose> poses = read_trajectory(options.input, options.trajectory);
  const std::vector<double> motions = Mover(options, poses).motions(poses);
  const double largest = greatest_of(motions), most = options.max_motion;
  const double needed = std::accumulate(motions.begin(), motions.end(), 0.0) / most;
  const bool has_jumps = !jumps_of(motions, std::min(kLeastJump, most)).empty();
  return largest > most * (1 + kRounding) && needed < kMostPoses && !has_jumps ? largest : 0;
}

void add_trajectory_changes(CLI::App& trajectory) {
  add_writer<ChangeCommand>(
      trajectory,
      {"resample", "Add poses on a smooth curve until all steps are small; the given poses stay",
       kTrajectoryHelp, kNewTrajectory,
       "Example: clearway trajectory resample path.txt -o dense.txt --max-motion 0.05 --model "
       "car.ply"},
      kAddResampleOptions, [](ChangeCommand& options) { perform(options); });
  add_writer<ChangeCommand>(
      trajectory,
      {"thin", "Leave out poses; each one left out is near a kept one", kTrajectoryHelp,
       kNewTrajectory,
       "Example: clearway trajectory thin path.txt -o sparse.txt --max-motion 0.01 --model "
       "car.ply"},
      options_with_motion("The most that a model point may move between a dropped pose and the "
                          "last kept pose before it"),
      [](ChangeCommand& options) {
        write_changed(options, {thin, ". The output does not show it any more",
                                "thin of {}: {}, of which {} are left"});
      });
  add_writer<SmoothCommand>(
      trajectory,
      {"smooth", "Put a smooth curve to a noisy path, and say which error covers the difference",
       kTrajectoryHelp, kNewTrajectory,
       "The model is required where rotations change. Without one, --within and --step hold for\n"
       "the positions.\n"
       "Example: clearway trajectory smooth path.txt -o smooth.txt --within 0.01 --model car.ply"},
      [](CLI::App& command, SmoothCommand& options) {
        add_own_options(command, options, [&] {
          add_required_fields(command, kSmoothFields, options.parameters, options.lengths);
          add_fields(command, kSmoothFields, options.parameters, options.lengths);
        });
      },
      write_smoothed);
}

}  // namespace clearway::tool
