#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "clearway/model.hpp"
#include "clearway/store.hpp"
#include "cli/support/console.hpp"
#include "cli/support/lengths.hpp"
#include "cli/support/options.hpp"
#include "cli/support/trajectory_options.hpp"
#include "cli/trajectory/commands.hpp"
#include "cli/trajectory/description.hpp"
#include "core/geometry/point_box.hpp"
#include "core/trajectory/trajectory_doubts.hpp"
#include "core/trajectory/trajectory_summary.hpp"
#include "core/util/format.hpp"
#include "io/files/json.hpp"

namespace clearway::tool {
namespace {

struct InfoOptions {
  std::filesystem::path input, environment, model;
  double radius = 0;
  FileUnit model_unit = {};
  ModelAxes model_axes;
  LengthOptions lengths;
  TrajectoryOptions trajectory;
  bool json = false;
};

StepMotion motion_of(const std::vector<Pose>& poses, const Box& model, double radius) {
  StepMotion motion;
  if (radius > 0) motion.above_radius = 0;
  for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
    const double step = motion_bound(model, poses[i], poses[i + 1]);
    motion.largest = std::max(motion.largest, step);
    if (motion.above_radius && step > radius) ++*motion.above_radius;
  }
  return motion;
}

void warn_of_axes(const std::string& name, Description& what) {
  const BodyAxis& up = what.summary.up;
  if (up.cosine >= kClearAxis && up.axis != 2) {
    what.file.warn(
        "up-axis",
        fmt::format("{}: the {} axis of the poses' frame points up, as in a camera's frame; "
                    "the model needs the same frame, not z up",
                    name, axis_name(up)),
        {{"cosine", up.cosine}});
  }
  const BodyAxis& forward = what.summary.forward;
  const bool ahead = forward.axis == 0 && !forward.negative;
  if (forward.cosine >= kClearAxis && !ahead) {
    what.file.warn("forward-axis",
                   fmt::format("{}: the motion is along the {} axis of the poses' frame; the "
                               "model's front has to point along that axis, not along x",
                               name, axis_name(forward)),
                   {{"cosine", forward.cosine}});
  }
}

void warn_of_scan(const InfoOptions& options, Description& what) {
  if (!what.scan || what.overlap.inside != 0 || what.file.poses.empty()) return;
  what.file.warn(
      "path-outside-scan",
      fmt::format("{}: no pose lies in the box of {}; their boxes are {:.6g} m apart. Unit, CRS or "
                  "frame may be another",
                  options.input.string(), options.environment.string(), what.overlap.distance),
      {{"distance", what.overlap.distance}});
}

/// Warns of jumps and of steps above the radius. Each step is in one of the two warnings, because
/// jumps need remedies different from those for steps that are all long.
void warn_of_steps(const InfoOptions& options, const Box& model, Description& what) {
  const std::vector<Pose>& poses = what.file.poses;
  const double least = options.radius > 0 ? options.radius : kLeastJump / what.file.metres_per_unit;
  const std::vector<Jump> jumps = jumps_of(step_lengths(poses), least);
  if (!jumps.empty()) {
    what.file.remarks.push_back(jump_warning(jumps, options.input.string() + ": ", "m", ""));
  }
  if (!what.motion || what.motion->above_radius.value_or(0) == 0) return;
  std::size_t above = 0;
  double largest = 0;
  for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
    const double motion = motion_bound(model, poses[i], poses[i + 1]);
    if (!(motion > options.radius) || std::ranges::binary_search(jumps, i, {}, &Jump::pose))
      continue;
    ++above;
    largest = std::max(largest, motion);
  }
  if (above == 0) return;
  what.file.warn(
      "steps-above-radius",
      fmt::format("{}: {} of {} steps move the model by more than the radius, up to {:.4g} m; "
                  "--between-poses or clearway trajectory resample close the gaps",
                  options.input.string(), format_count(above), format_count(what.summary.poses - 1),
                  largest),
      {{"steps", static_cast<double>(above)}, {"largest_motion", largest}});
}

Description describe(InfoOptions& options) {
  Description what;
  if (!options.environment.empty()) {
    const Store store(options.environment);
    if (const auto warning = options.lengths.convert_for(store)) log_message(*warning);
    set_environment_unit(store, options.trajectory);
    options.trajectory.default_crs = store.crs_wkt();
    if (store.point_count() > 0) what.scan = store.box();
  }
  what.file = read_trajectory_file(options.input, options.trajectory);
  const std::vector<Pose>& poses = what.file.poses;
  what.summary = summarize_trajectory(poses);
  if (what.scan && !poses.empty()) what.overlap = overlap_of(poses, what.summary.box, *what.scan);
  Box model{};
  if (!options.model.empty()) {
    // No other place of a mesh is farther out than its vertices.
    model = box_of(
        read_model_points(options.model, {.unit = options.model_unit,
                                          .environment_unit = options.trajectory.environment_unit,
                                          .forward = options.model_axes.forward,
                                          .up = options.model_axes.up,
                                          .vertices_only = true}));
    what.motion = motion_of(poses, model, options.radius);
  }
  warn_of_axes(options.input.string(), what);
  warn_of_scan(options, what);
  warn_of_steps(options, model, what);
  return what;
}

void run_info(InfoOptions& options) {
  const Description what = describe(options);
  for (const Message& remark : what.file.remarks) log_message(remark);
  print(options.json ? indented_text(json_of(what)) : text_of(what));
}

}  // namespace

void add_trajectory_info(CLI::App& trajectory) {
  const auto options = std::make_shared<InfoOptions>();
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
  command->callback([options] { run_info(*options); });
}

}  // namespace clearway::tool
