#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/support/options.hpp"
#include "cli/support/trajectory_options.hpp"
#include "cli/trajectory/commands.hpp"
#include "core/geometry/angle.hpp"
#include "core/trajectory/trajectory_doubts.hpp"
#include "core/trajectory/trajectory_summary.hpp"
#include "core/util/format.hpp"
#include "io/files/json.hpp"
#include "report/label_text.hpp"

namespace clearway::tool {
namespace {

struct PathInfoCommand : ChangeCommand {
  double radius = 0;
};

/// How far the model moves from pose to pose.
struct StepMotion {
  std::vector<double> steps;
  double largest = 0;
  std::optional<std::size_t> above_radius = {};  ///< steps longer than the radius, if it is given
};

/// All that `clearway trajectory info` prints.
struct PathInfo {
  TrajectoryFile file;
  TrajectorySummary summary;
  std::optional<Box> scan;
  double distance = 0;     ///< metres between the box of the positions and that of the scan
  std::size_t inside = 0;  ///< number of poses in the scan's box
  std::optional<StepMotion> motion;
};

/// The least cosine between an axis and a direction at which the axis is said to point there.
constexpr double kClearAxis = 0.9;

/// The name of an axis: "x", "-x" and so on.
std::string axis_name(const BodyAxis& axis) {
  return std::string(axis.negative ? "-" : "") + "xyz"[axis.axis];
}

void warn_of_axes(const std::string& name, PathInfo& what) {
  const BodyAxis& up = what.summary.up;
  if (up.cosine >= kClearAxis && up.axis != 2) {
    what.file.warn("up-axis", {{"cosine", up.cosine}},
                   "{}: the {} axis of the poses' frame points up, as in a camera's frame; "
                   "the model needs the same frame, not z up",
                   name, axis_name(up));
  }
  const BodyAxis& forward = what.summary.forward;
  const bool ahead = forward.axis == 0 && !forward.negative;
  if (forward.cosine >= kClearAxis && !ahead) {
    what.file.warn("forward-axis", {{"cosine", forward.cosine}},
                   "{}: the motion is along the {} axis of the poses' frame; the "
                   "model's front has to point along that axis, not along x",
                   name, axis_name(forward));
  }
}

/// Warns of jumps and of steps above the radius. Each step is in one of the two warnings, because
/// jumps need remedies different from those for steps that are all long.
void warn_of_steps(const PathInfoCommand& options, PathInfo& what) {
  const double least = options.radius > 0 ? options.radius : kLeastJump / what.file.metres_per_unit;
  const std::vector<Jump> jumps = jumps_of(step_lengths(what.file.poses), least);
  if (!jumps.empty()) {
    what.file.remarks.push_back(jump_warning(jumps, options.input.string() + ": ", "m", ""));
  }
  if (!what.motion || what.motion->above_radius.value_or(0) == 0) return;
  const std::vector<double>& steps = what.motion->steps;
  std::size_t above = 0;
  double largest = 0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (!(steps[i] > options.radius) || std::ranges::binary_search(jumps, i, {}, &Jump::pose))
      continue;
    ++above;
    largest = std::max(largest, steps[i]);
  }
  if (above == 0) return;
  what.file.warn(
      "steps-above-radius", {{"steps", static_cast<double>(above)}, {"largest_motion", largest}},
      "{}: {} of {} steps move the model by more than the radius, up to {:.4g} m; "
      "--between-poses or clearway trajectory resample close the gaps",
      options.input.string(), format_count(above), format_count(what.summary.poses - 1), largest);
}

PathInfo path_info(PathInfoCommand& options) {
  PathInfo what;
  const std::optional<Store> store = take_environment(options);
  if (store && store->point_count() > 0) what.scan = store->box();
  what.file = read_trajectory_file(options.input, options.trajectory);
  const std::vector<Pose>& poses = what.file.poses;
  what.summary = summarize_trajectory(poses);
  if (!options.model.empty()) {
    what.motion = StepMotion{motions_of(poses, box_of_model(options))};
    const std::vector<double>& steps = what.motion->steps;
    for (const double step : steps) what.motion->largest = std::max(what.motion->largest, step);
    if (options.radius > 0) {
      what.motion->above_radius = static_cast<std::size_t>(
          std::ranges::count_if(steps, [&](double step) { return step > options.radius; }));
    }
  }
  warn_of_axes(options.input.string(), what);
  if (what.scan && !poses.empty()) {
    what.distance = what.scan->distance(what.summary.box);
    what.inside = static_cast<std::size_t>(std::ranges::count_if(
        poses, [&](const Pose& pose) { return what.scan->contains(pose.position()); }));
    if (what.inside == 0) {
      what.file.warn("path-outside-scan", {{"distance", what.distance}},
                     "{}: no pose lies in the box of {}; their boxes are {:.6g} m apart. Unit, CRS "
                     "or frame may be another",
                     options.input.string(), options.environment.string(), what.distance);
    }
  }
  warn_of_steps(options, what);
  return what;
}

/// The angles, in degrees, of a model with x forward, y left and z up, in a world with y north and
/// z up.
struct PoseAngles {
  double heading;  ///< clockwise from y, 0 to 360
  double pitch;    ///< nose up
  double roll;     ///< right side down
};

PoseAngles angles_of(const Pose& pose) {
  const double* r = pose.rotation;
  double heading = std::atan2(r[0], r[3]) / kDegree;
  if (heading < 0) heading += 360;
  return {heading, std::asin(std::clamp(r[6], -1.0, 1.0)) / kDegree,
          std::atan2(r[7], r[8]) / kDegree};
}

/// Calls visit(label, value) for each label that the file gives a pose, without those that belong
/// beside a chainage, because there is none here.
template <typename Visit>
void for_each_label_of(const TrajectoryFile& file, std::size_t pose, const Visit& visit) {
  for_each_label([&](const auto& label) {
    const auto& values = label.of(file.labels);
    if (label.place != LabelPlace::kBesideChainage && !values.empty()) visit(label, values[pose]);
  });
}

Json pose_json(const TrajectoryFile& file, std::size_t pose) {
  const PoseAngles angles = angles_of(file.poses[pose]);
  Json out{{"position", file.poses[pose].translation},
           {"rotation", file.poses[pose].rotation},
           {"heading_degrees", angles.heading},
           {"pitch_degrees", angles.pitch},
           {"roll_degrees", angles.roll}};
  for_each_label_of(file, pose,
                    [&](const auto& label, const auto& value) { out[label.key] = value; });
  return out;
}

Json axis_json(const BodyAxis& axis) {
  if (axis.cosine == 0) return nullptr;
  return {{"axis", axis_name(axis)}, {"mean_cosine", axis.cosine}};
}

Json json_of(const PathInfo& what) {
  const TrajectorySummary& s = what.summary;
  const TrajectoryFile& file = what.file;
  Json out{{"format", name_of(file.format)}, {"poses", s.poses}};
  if (!file.crs.empty()) out["crs"] = file.crs;
  if (s.poses > 0) {
    out["first_pose"] = pose_json(file, 0);
    out["last_pose"] = pose_json(file, s.poses - 1);
    out["bounds"] = s.box;
  }
  out["length"] = s.length;
  const std::vector<double>& times = file.labels.time;
  if (!times.empty()) out["duration_seconds"] = times.back() - times.front();
  out["median_step"] = s.median_step;
  out["largest_step"] = {{"from_pose", s.largest_step_pose}, {"metres", s.largest_step}};
  out["still_steps"] = s.still_steps;
  out["largest_turn"] = {{"from_pose", s.largest_turn_pose}, {"degrees", s.largest_turn / kDegree}};
  out["total_turn_degrees"] = s.total_turn / kDegree;
  out["orthonormal_within"] = s.skew;
  out["up"] = axis_json(s.up);
  out["forward"] = axis_json(s.forward);
  if (what.scan) {
    out["environment"] = {
        {"bounds", *what.scan}, {"distance", what.distance}, {"poses_inside", what.inside}};
  }
  if (what.motion) {
    out["largest_motion"] = what.motion->largest;
    if (what.motion->above_radius) out["steps_above_radius"] = *what.motion->above_radius;
  }
  add_remarks(out, file.remarks);
  return out;
}

std::string tilt_text(const char* part, double up) {
  const double shown = std::abs(up);
  if (shown < 0.05) return fmt::format("{} level", part);
  return fmt::format("{} {:.1f} degrees {}", part, shown, up > 0 ? "up" : "down");
}

/// A pose, its attitude and its labels in words: "1.000 2.000 3.000; heading 90.0 degrees (most
/// along x), nose 1.4 degrees down, right side 0.2 degrees up; time 5".
std::string pose_text(const TrajectoryFile& file, std::size_t number) {
  static constexpr std::array kQuarters{"along y", "along x", "against y", "against x"};
  const Pose& pose = file.poses[number];
  const PoseAngles angles = angles_of(pose);
  const auto quarter = static_cast<std::size_t>(std::lround(angles.heading / 90)) % 4;
  std::string text = fmt::format(
      "{:.3f} {:.3f} {:.3f}; heading {:.1f} degrees (most {}), {}, {}", pose.translation[0],
      pose.translation[1], pose.translation[2], angles.heading, kQuarters[quarter],
      tilt_text("nose", angles.pitch), tilt_text("right side", -angles.roll));
  for_each_label_of(file, number, [&](const auto& label, const auto& value) {
    text += "; " + label_text(label, value);
  });
  return text;
}

std::string axis_text(const BodyAxis& axis, const char* where) {
  if (axis.cosine < kClearAxis)
    return fmt::format("no axis of the poses' frame {} throughout", where);
  return fmt::format("{} of the poses' frame {} (mean cosine {:.3f})", axis_name(axis), where,
                     axis.cosine);
}

std::string time_text(const TrajectoryFile& file, double length) {
  const std::vector<double>& times = file.labels.time;
  if (times.empty()) return "not known";
  const double seconds = times.back() - times.front();
  if (!(seconds > 0)) return fmt::format("{:.6g} s", seconds);
  return fmt::format("{:.6g} s, {:.3g} m/s on average", seconds,
                     length * file.metres_per_unit / seconds);
}

/// The description in words, with one fact on each line.
std::string text_of(const PathInfo& what) {
  const TrajectorySummary& s = what.summary;
  const TrajectoryFile& file = what.file;
  std::string text;
  const auto add = [&text](const char* name, const std::string& value) {
    text += fmt::format("{:<11}  {}\n", name, value);
  };
  add("format", name_of(file.format) + (file.crs.empty() ? "" : ", turned into " + file.crs));
  add("poses", format_count(s.poses));
  if (s.poses == 0) return text;
  const char* const unit = file.metres_per_unit == 1 ? "m" : "units of the CRS";
  add("first pose", pose_text(file, 0));
  add("last pose", pose_text(file, s.poses - 1));
  add("bounds", fmt::format("{:.3f} {:.3f} {:.3f} to {:.3f} {:.3f} {:.3f}", s.box.lo.x, s.box.lo.y,
                            s.box.lo.z, s.box.hi.x, s.box.hi.y, s.box.hi.z));
  add("length", fmt::format("{:.6g} {}", s.length, unit));
  add("time", time_text(file, s.length));
  add("steps",
      fmt::format("median {:.4g}, largest {:.4g} {} from pose {}; {} do not move", s.median_step,
                  s.largest_step, unit, s.largest_step_pose, format_count(s.still_steps)));
  std::string turning =
      fmt::format("largest {:.4g} degrees from pose {}, {:.4g} in all", s.largest_turn / kDegree,
                  s.largest_turn_pose, s.total_turn / kDegree);
  if (s.length > 0) {
    turning += fmt::format(", {:.3g} degrees a metre",
                           s.total_turn / kDegree / (s.length * file.metres_per_unit));
  }
  add("turning", turning);
  add("up", axis_text(s.up, "points up (world z)"));
  add("forward", axis_text(s.forward, "points along the motion"));
  add("rotations", fmt::format("orthonormal within {:.2g}", s.skew));
  if (what.scan) {
    const double share = 100.0 * static_cast<double>(what.inside) / static_cast<double>(s.poses);
    add("environment", fmt::format("{:.4g} % of the poses lie in its box; the boxes are {:.6g} m "
                                   "apart",
                                   share, what.distance));
  }
  if (what.motion) {
    const auto& above = what.motion->above_radius;
    add("model", fmt::format("at most {:.4g} m from pose to pose", what.motion->largest) +
                     (above ? ", " + format_count(*above) + " steps above the radius" : ""));
  }
  return text;
}

void run_path_info(PathInfoCommand& options) {
  const PathInfo what = path_info(options);
  for (const Message& remark : what.file.remarks) log_message(remark);
  print(options.json ? indented_text(json_of(what)) : text_of(what));
}

}  // namespace

void add_trajectory_info(CLI::App& trajectory) {
  const auto options = std::make_shared<PathInfoCommand>();
  CLI::App* command = trajectory.add_subcommand(
      "info", "Print how a trajectory is understood: format, poses, way, axes, and what is odd");
  command->add_option("IN", options->input, kTrajectoryHelp)->type_name("PATH")->required();
  add_file(*command, "--env", options->environment,
           "A store: says whether the path lies in the scan, and gives the CRS");
  CLI::Option* model = add_file(*command, "--model", options->model,
                                "The model: says how far it moves from pose to pose");
  add_model_unit(*command, options->model_unit);
  add_turn_options(*command, options->model_axes.forward, options->model_axes.up);
  options->lengths
      .add(*command, "--radius", options->radius,
           "Count the steps that move the model by more than this; needs --model")
      ->needs(model);
  add_trajectory_options(*command, options->trajectory, options->lengths);
  command->add_flag("--json", options->json, "Print one JSON object");
  command->footer("Example: clearway trajectory info path.csv --angles deg,enu --env site.h5");
  command->callback([options] { run_path_info(*options); });
}

}  // namespace clearway::tool
