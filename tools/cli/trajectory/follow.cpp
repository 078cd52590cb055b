#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "clearway/error.hpp"
#include "cli/support/options.hpp"
#include "cli/support/trajectory_options.hpp"
#include "cli/trajectory/commands.hpp"
#include "cli/vehicle/vehicle_inputs.hpp"
#include "core/trajectory/chainage.hpp"
#include "core/trajectory/follow/follow_path.hpp"
#include "core/trajectory/trajectory_doubts.hpp"
#include "core/util/format.hpp"
#include "io/files/file.hpp"
#include "io/files/json.hpp"
#include "io/files/thread_limit.hpp"
#include "io/models/vehicle_file.hpp"

namespace clearway::tool {
namespace {

struct FollowCommand : PoseCommand {
  std::filesystem::path vehicle;
  std::string body;  ///< name of a body of `vehicle`
  std::optional<double> at;
  std::optional<std::array<double, 2>> pivots;
  int threads = 0;
};

BodyMount mount_of(const FollowCommand& options) {
  if (!options.at && !options.pivots) {
    throw UsageError(
        "where the body is on the path is missing; expected --at or --pivots, for example --at 10 "
        "or --pivots 10,-10, or --vehicle and --body");
  }
  if (options.at) return BodyStation{*options.at};
  const auto [front, rear] = *options.pivots;
  if (front == rear) {
    throw UsageError("--pivots: both are " + format_number(front) +
                     " m ahead; expected two different places, for example 10,-10");
  }
  return BodyPivots{front, rear};
}

/// The labels of each pose of the body: those of the place of the path where the origin of its
/// frame is, or between its pivots is taken to be.
PoseLabels labels_of(const FollowedPath& followed, const PathStations& path, double at,
                     const PoseLabels& labels) {
  if (at == 0) return labels_at({followed.of.begin(), followed.of.end()}, labels);
  std::vector<double> lengths;
  for (std::size_t i = 0; i < path.poses().size(); ++i) lengths.push_back(path.of_pose(i));
  return made_labels(labels, [&](const std::vector<double>& values) {
    std::vector<double> out;
    for (const std::uint64_t i : followed.of) {
      out.push_back(value_at(lengths, values, path.of_pose(i) + at));
    }
    return out;
  });
}

/// The first and last pose of each run of consecutive poses.
Json ranges_of(const std::vector<std::uint64_t>& poses) {
  Json ranges = Json::array();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (i > 0 && poses[i] == poses[i - 1] + 1) {
      ranges.back()[1] = poses[i];
    } else {
      ranges.push_back({poses[i], poses[i]});
    }
  }
  return ranges;
}

/// A body's poses and their labels, the lists of what is odd, and the length of the path in
/// metres.
struct Placed {
  FollowedPath followed = {};
  PoseLabels labels = {};
  double path_length = 0;
};

WrittenPoses written(const FollowCommand& options, const Placed& placed, std::size_t path_poses) {
  const FollowedPath& followed = placed.followed;
  const bool is_of_vehicle = !options.vehicle.empty();
  Json report{{"poses_in", path_poses},
              {"poses_out", followed.poses.size()},
              {"length", placed.path_length}};
  if (options.at) report["at"] = *options.at;
  if (options.pivots) report["pivots"] = *options.pivots;
  if (is_of_vehicle) {
    report["vehicle"] = options.vehicle.string();
    report["body"] = options.body;
  }
  report["off_path"] = ranges_of(followed.off_path);
  report["undefined"] = ranges_of(followed.undefined);
  report["folded"] = ranges_of(followed.folded);
  report["turned"] = ranges_of(followed.turned);
  if (is_of_vehicle) {
    report["transient"] = ranges_of(followed.transient);
    report["rolled_back"] = ranges_of(followed.rolled_back);
  }
  return {
      fmt::format("{}, from {}; the path is {:.6g} m long", counted(followed.poses.size(), "pose"),
                  format_count(path_poses), placed.path_length),
      std::move(report)};
}

/// Places a body of its own at the station or on the pivots of the options.
Placed place_by_options(const FollowCommand& options, const TrajectoryFile& given, int threads) {
  const BodyMount mount = mount_of(options);
  const auto path = on_path(options, [&] { return PathStations(given.poses, threads); });
  Placed placed{.followed = on_path(options, [&] { return follow_path(path, mount, threads); }),
                .path_length = path.length()};
  if (placed.followed.poses.empty()) {
    throw InputError(fmt::format(
        "{}: the path is {} m long, and the body has a pose nowhere on it; expected a longer path, "
        "or stations nearer to its poses",
        options.input.string(), format_number(std::round(path.length() * 1e3) / 1e3)));
  }
  for (const Message& doubt : doubts_about(placed.followed, path, mount, options.input.string())) {
    log_message(doubt);
  }
  placed.labels = labels_of(placed.followed, path, options.at.value_or(0), given.labels);
  return placed;
}

/// Places a body of the vehicle's file.
Placed place_of_vehicle(const FollowCommand& options, const TrajectoryFile& path, int threads) {
  std::vector<Message> doubts;
  Placed placed{.path_length =
                    on_path(options, [&] { return PathStations(path.poses, threads).length(); })};
  const Body body = place_body(options.vehicle, options.body, path.poses,
                               {.model = {}, .trajectory = options.trajectory, .threads = threads},
                               &doubts, placed.followed);
  for (const Message& doubt : doubts) log_message(doubt);
  placed.followed.poses = body.poses;
  placed.followed.of.assign(body.path_pose.begin(), body.path_pose.end());
  placed.labels = labels_at({body.path_pose.begin(), body.path_pose.end()}, path.labels);
  return placed;
}

void write_followed(FollowCommand& options) {
  const bool is_of_vehicle = !options.vehicle.empty();
  if (is_of_vehicle && options.body.empty()) {
    throw UsageError("--vehicle: which body is missing; expected --body with its name");
  }
  if (is_of_vehicle) {
    refuse_overwriting_inputs(options, vehicle_inputs(options.vehicle, {}));
  } else {
    mount_of(options);  // it throws where that cannot be used
    refuse_overwriting_inputs(options);
  }
  const int threads = threads_or_all(options.threads);
  check_threads(threads);
  write_output(options, [&](const std::filesystem::path& file) {
    const TrajectoryFile path = read_path(options);
    if (path.poses.empty()) {
      throw InputError(options.input.string() + ": no poses; nothing to follow");
    }
    const Placed placed = is_of_vehicle ? place_of_vehicle(options, path, threads)
                                        : place_by_options(options, path, threads);
    const auto jumps = jumps_of(step_lengths(path.poses), kLeastJump);
    if (!jumps.empty()) {
      log_message(jump_warning(jumps, options.input.string() + ": ", "m",
                               ". Where the body is on that part of the path is a guess"));
    }
    const FollowedPath& followed = placed.followed;
    std::vector<std::uint32_t> path_pose;
    if (file_ending(options.output) == ".csv") {
      path_pose.assign(followed.of.begin(), followed.of.end());
    }
    write_poses(followed.poses, placed.labels, path, file, path_pose);
    return written(options, placed, path.poses.size());
  });
}

void add_follow_options(CLI::App& command, FollowCommand& options) {
  CLI::Option* vehicle = add_file(command, "--vehicle", options.vehicle,
                                  "The JSON file of a vehicle, of which --body names one body");
  command.add_option("--body", options.body, "The name of a body of the vehicle's file")
      ->type_name("NAME")
      ->needs(vehicle);
  CLI::Option* at = options.lengths.add(
      command, "--at", options.at,
      "The body has the path's pose so many metres ahead; negative: behind", FieldRange::kAny);
  options.lengths
      .add(command, "--pivots", options.pivots,
           "Two places of the body lie on the path, so many metres ahead or behind; "
           "the body points from the second to the first")
      ->excludes(at)
      ->excludes(vehicle);
  at->excludes(vehicle);
  add_trajectory_options(command, options.trajectory, options.lengths);
  add_threads_option(command, options.threads);
}

}  // namespace

void add_trajectory_follow(CLI::App& trajectory) {
  add_writer<FollowCommand>(
      trajectory,
      {"follow",
       "Write the poses of a body that follows the path, or of one that is towed along it",
       kTrajectoryHelp,
       "The body's poses: a table with the unit and the stations of the path or, where it "
       "names neither, 16 numbers a line, a row-major 4x4 matrix; a name that ends in .csv gets "
       "a table, whose column path_pose says which pose of the path each belongs to",
       "Example: clearway trajectory follow path.txt -o wagon.txt --pivots 10,-10"},
      add_follow_options, write_followed);
}

}  // namespace clearway::tool
