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
#include "cli/support/trajectory_options.hpp"
#include "cli/trajectory/commands.hpp"
#include "cli/trajectory/stations.hpp"
#include "core/trajectory/chainage.hpp"
#include "core/trajectory/follow/follow_path.hpp"
#include "core/trajectory/trajectory_doubts.hpp"
#include "core/util/format.hpp"
#include "io/files/pending_file.hpp"
#include "io/paths/trajectory_file.hpp"
#include "search/threads.hpp"

namespace clearway::tool {
namespace {

struct FollowOptions {
  std::filesystem::path input, output;
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
        "or --pivots 10,-10");
  }
  if (options.at) return BodyStation{*options.at};
  const auto [front, rear] = *options.pivots;
  if (front == rear) {
    throw UsageError("--pivots: both are " + format_number(front) +
                     " m ahead; expected two different places, for example 10,-10");
  }
  return BodyPivots{front, rear};
}

std::vector<Pose> read_path(const FollowOptions& options, PoseLabels& labels) {
  std::vector<Message> remarks;
  std::vector<Pose> poses = read_trajectory(options.input, options.trajectory, &remarks, &labels);
  for (const Message& remark : remarks) log_message(remark);
  tell_of_labels(options.input, labels);
  if (poses.empty()) throw InputError(options.input.string() + ": no poses; nothing to follow");
  return poses;
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

/// The station of each pose of the body: that of the place of the path where the origin of its
/// frame is, or between its pivots is taken to be. Empty where the path has none.
std::vector<double> stations_of(const FollowedPath& followed, const PathStations& path, double at,
                                const std::vector<double>& stations) {
  std::vector<double> out;
  if (stations.empty()) return out;
  std::vector<double> lengths;
  for (std::size_t i = 0; i < path.poses().size(); ++i) lengths.push_back(path.of_pose(i));
  for (const std::uint64_t i : followed.of) {
    out.push_back(at == 0 ? stations[i] : value_at(lengths, stations, path.of_pose(i) + at));
  }
  return out;
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

void report(const FollowOptions& options, const FollowedPath& followed, const PathStations& path) {
  spdlog::info("{}: {}, from {}; the path is {:.6g} m long", options.output.string(),
               counted(followed.poses.size(), "pose"), format_count(path.poses().size()),
               path.length());
  if (!options.json) return;
  nlohmann::ordered_json json{{"poses_in", path.poses().size()},
                              {"poses_out", followed.poses.size()},
                              {"length", path.length()}};
  if (options.at) json["at"] = *options.at;
  if (options.pivots) json["pivots"] = *options.pivots;
  json["off_path"] = ranges_of(followed.off_path);
  json["undefined"] = ranges_of(followed.undefined);
  json["folded"] = ranges_of(followed.folded);
  json["turned"] = ranges_of(followed.turned);
  print(json.dump(2) + "\n");
}

void write_followed(const FollowOptions& options) {
  const BodyMount mount = mount_of(options);
  refuse_overwriting(options.output, {options.input});
  const int threads = threads_or_all(options.threads);
  check_threads(threads);
  PendingFile output(options.output, options.force);
  PoseLabels labels;
  const std::vector<Pose> poses = read_path(options, labels);
  const auto path = on_path(options, [&] { return PathStations(poses, threads); });
  const auto followed = on_path(options, [&] { return follow_path(path, mount, threads); });
  refuse_nowhere(options, followed, path);
  for (const Message& doubt : doubts_about(followed, path, mount, options.input.string())) {
    log_message(doubt);
  }
  const auto jumps = jumps_of(step_lengths(poses), kLeastJump);
  if (!jumps.empty()) {
    log_message(jump_warning(jumps, options.input.string() + ": ", "m",
                             ". Where the body is on that part of the path is a guess"));
  }
  ConsoleProgress progress;
  write_poses(followed.poses, stations_of(followed, path, options.at.value_or(0), labels.station),
              output.partial(), progress);
  output.publish();
  report(options, followed, path);
}

}  // namespace

void add_trajectory_follow(CLI::App& trajectory) {
  const auto options = std::make_shared<FollowOptions>();
  CLI::App* command = trajectory.add_subcommand(
      "follow", "Write the poses of a body that follows the path, at a station or on two pivots");
  command->add_option("IN", options->input, kTrajectoryHelp)->type_name("FILE")->required();
  command
      ->add_option("-o,--output", options->output,
                   "The body's poses: 16 numbers a line, a row-major 4x4 matrix")
      ->type_name("FILE")
      ->required();
  CLI::Option* at = options->lengths.add(
      *command, "--at", options->at,
      "The body has the path's pose so many metres ahead; negative: behind", LengthRange::kAny);
  options->lengths
      .add(*command, "--pivots", options->pivots,
           "Two places of the body lie on the path, so many metres ahead or behind; "
           "the body points from the second to the first")
      ->excludes(at);
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
