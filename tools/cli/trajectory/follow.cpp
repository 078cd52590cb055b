#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "clearway/error.hpp"
#include "clearway/trajectory.hpp"
#include "cli/support/console.hpp"
#include "cli/support/lengths.hpp"
#include "cli/support/options.hpp"
#include "cli/support/program_json.hpp"
#include "cli/support/trajectory_options.hpp"
#include "cli/trajectory/commands.hpp"
#include "cli/trajectory/made_labels.hpp"
#include "core/trajectory/chainage.hpp"
#include "core/trajectory/follow/follow_path.hpp"
#include "core/trajectory/trajectory_doubts.hpp"
#include "core/util/format.hpp"
#include "io/files/file.hpp"
#include "io/files/json.hpp"
#include "io/files/pending_file.hpp"
#include "io/files/thread_limit.hpp"
#include "io/models/vehicle_file.hpp"
#include "io/paths/trajectory_file.hpp"

namespace clearway::tool {
namespace {

struct FollowOptions {
  std::filesystem::path input, output, vehicle;
  std::string body;  ///< name of a body of `vehicle`
  std::optional<double> at;
  std::optional<std::array<double, 2>> pivots;
  LengthOptions lengths;
  TrajectoryOptions trajectory;
  int threads = 0;
  bool force = false;
  bool json = false;
};

BodyMount mount_of(const FollowOptions& options) {
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

bool writes_path_poses(const FollowOptions& options) {
  return file_ending(options.output) == ".csv";
}

TrajectoryFile read_path(const FollowOptions& options) {
  TrajectoryFile path = read_trajectory_file(options.input, options.trajectory);
  for (const Message& remark : path.remarks) log_message(remark);
  tell_of_labels(options.input, path.labels);
  if (path.poses.empty())
    throw InputError(options.input.string() + ": no poses; nothing to follow");
  return path;
}

/// Does `work`; an InputError that it throws about the path is given the name of the path's file.
template <typename Work>
auto on_path(const FollowOptions& options, const Work& work) {
  try {
    return work();
  } catch (const InputError& error) {
    throw InputError(options.input.string() + ": " + error.what());
  }
}

/// The labels of each pose of the body: those of the place of the path where the origin of its
/// frame is, or between its pivots is taken to be.
PoseLabels labels_of(const FollowedPath& followed, const PathStations& path, double at,
                     const PoseLabels& labels) {
  std::vector<double> lengths;
  for (std::size_t i = 0; i < path.poses().size(); ++i) lengths.push_back(path.of_pose(i));
  return made_labels(labels, [&](const std::vector<double>& values) {
    std::vector<double> out;
    for (const std::uint64_t i : followed.of) {
      out.push_back(at == 0 ? values[i] : value_at(lengths, values, path.of_pose(i) + at));
    }
    return out;
  });
}

void refuse_nowhere(const FollowOptions& options, const FollowedPath& followed,
                    const PathStations& path) {
  if (!followed.poses.empty()) return;
  throw InputError(fmt::format(
      "{}: the path is {} m long, and the body has a pose nowhere on it; expected a longer path, "
      "or stations nearer to its poses",
      options.input.string(), format_number(std::round(path.length() * 1e3) / 1e3)));
}

/// The first and last pose of each run of consecutive poses.
nlohmann::ordered_json ranges_of(const std::vector<std::uint64_t>& poses) {
  auto ranges = nlohmann::ordered_json::array();
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
  FollowedPath followed;
  double path_length;
  PoseLabels labels = {};
};

void report(const FollowOptions& options, const Placed& placed, std::size_t path_poses) {
  const FollowedPath& followed = placed.followed;
  spdlog::info("{}: {}, from {}; the path is {:.6g} m long", options.output.string(),
               counted(followed.poses.size(), "pose"), format_count(path_poses),
               placed.path_length);
  if (!options.json) return;
  nlohmann::ordered_json json{{"poses_in", path_poses},
                              {"poses_out", followed.poses.size()},
                              {"length", placed.path_length}};
  if (options.at) json["at"] = *options.at;
  if (options.pivots) json["pivots"] = *options.pivots;
  if (!options.vehicle.empty()) {
    json["vehicle"] = options.vehicle.string();
    json["body"] = options.body;
  }
  json["off_path"] = ranges_of(followed.off_path);
  json["undefined"] = ranges_of(followed.undefined);
  json["folded"] = ranges_of(followed.folded);
  json["turned"] = ranges_of(followed.turned);
  if (!options.vehicle.empty()) {
    json["transient"] = ranges_of(followed.transient);
    json["rolled_back"] = ranges_of(followed.rolled_back);
  }
  print(indented_text(json));
}

/// Places a body of its own at the station or on the pivots of the options.
Placed place_by_options(const FollowOptions& options, const TrajectoryFile& given, int threads) {
  const BodyMount mount = mount_of(options);
  const auto path = on_path(options, [&] { return PathStations(given.poses, threads); });
  Placed placed{on_path(options, [&] { return follow_path(path, mount, threads); }), path.length()};
  refuse_nowhere(options, placed.followed, path);
  for (const Message& doubt : doubts_about(placed.followed, path, mount, options.input.string())) {
    log_message(doubt);
  }
  placed.labels = labels_of(placed.followed, path, options.at.value_or(0), given.labels);
  return placed;
}

/// Places a body of the vehicle's file.
Placed place_of_vehicle(const FollowOptions& options, const TrajectoryFile& path, int threads) {
  const std::vector<Pose>& poses = path.poses;
  std::vector<Message> doubts;
  Placed placed{.followed = {}, .path_length = on_path(options, [&] {
                                  return PathStations(poses, threads).length();
                                })};
  const Body body = place_body(options.vehicle, options.body, poses,
                               {.model = {}, .trajectory = options.trajectory, .threads = threads},
                               &doubts, placed.followed);
  for (const Message& doubt : doubts) log_message(doubt);
  placed.followed.poses = body.poses;
  placed.followed.of.assign(body.path_pose.begin(), body.path_pose.end());
  placed.labels = made_labels(path.labels, [&](const std::vector<double>& values) {
    std::vector<double> out;
    for (const std::uint32_t pose : body.path_pose) out.push_back(values[pose]);
    return out;
  });
  return placed;
}

void write(const FollowOptions& options, const TrajectoryFile& path, const Placed& placed,
           const std::filesystem::path& file) {
  ConsoleProgress progress;
  const FollowedPath& followed = placed.followed;
  std::vector<std::uint32_t> path_pose;
  if (writes_path_poses(options)) path_pose.assign(followed.of.begin(), followed.of.end());
  write_poses(followed.poses, placed.labels, path, file, progress, {.path_pose = path_pose});
}

void check_options(const FollowOptions& options) {
  if (!options.vehicle.empty() && options.body.empty()) {
    throw UsageError("--vehicle: which body is missing; expected --body with its name");
  }
  if (options.vehicle.empty()) mount_of(options);
}

void write_followed(const FollowOptions& options) {
  check_options(options);
  std::vector<std::filesystem::path> inputs{options.input};
  if (!options.vehicle.empty()) inputs.push_back(options.vehicle);
  refuse_overwriting(options.output, inputs);
  const int threads = threads_or_all(options.threads);
  check_threads(threads);
  PendingFile output(options.output, options.force);
  const TrajectoryFile path = read_path(options);
  const Placed placed = options.vehicle.empty() ? place_by_options(options, path, threads)
                                                : place_of_vehicle(options, path, threads);
  const auto jumps = jumps_of(step_lengths(path.poses), kLeastJump);
  if (!jumps.empty()) {
    log_message(jump_warning(jumps, options.input.string() + ": ", "m",
                             ". Where the body is on that part of the path is a guess"));
  }
  write(options, path, placed, output.partial());
  output.publish();
  report(options, placed, path.poses.size());
}

}  // namespace

void add_trajectory_follow(CLI::App& trajectory) {
  const auto options = std::make_shared<FollowOptions>();
  CLI::App* command = trajectory.add_subcommand(
      "follow",
      "Write the poses of a body that follows the path, or of one that is towed along it");
  add_file(*command, "IN", options->input, kTrajectoryHelp)->required();
  add_file(
      *command, "-o,--output", options->output,
      "The body's poses: a table with the unit and the stations of the path or, where it "
      "names neither, 16 numbers a line, a row-major 4x4 matrix; a name that ends in .csv gets "
      "a table, whose column path_pose says which pose of the path each belongs to")
      ->required();
  CLI::Option* vehicle = add_file(*command, "--vehicle", options->vehicle,
                                  "The JSON file of a vehicle, of which --body names one body");
  command->add_option("--body", options->body, "The name of a body of the vehicle's file")
      ->type_name("NAME")
      ->needs(vehicle);
  CLI::Option* at = options->lengths.add(
      *command, "--at", options->at,
      "The body has the path's pose so many metres ahead; negative: behind", FieldRange::kAny);
  options->lengths
      .add(*command, "--pivots", options->pivots,
           "Two places of the body lie on the path, so many metres ahead or behind; "
           "the body points from the second to the first")
      ->excludes(at)
      ->excludes(vehicle);
  at->excludes(vehicle);
  add_trajectory_options(*command, options->trajectory, options->lengths);
  add_threads_option(*command, options->threads);
  command->add_flag("--force", options->force, "Overwrite an existing output");
  command->add_flag("--json", options->json, "One JSON object on standard output");
  command->footer("Example: clearway trajectory follow path.txt -o wagon.txt --pivots 10,-10");
  command->callback([options] {
    run_stoppable(options->output, kStartsAgain, [&] { write_followed(*options); });
  });
}

}  // namespace clearway::tool
