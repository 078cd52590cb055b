#include <spdlog/spdlog.h>

#include <utility>

#include "cli/commands.hpp"
#include "cli/support/console.hpp"
#include "cli/support/options.hpp"
#include "cli/trajectory/commands.hpp"
#include "io/files/file.hpp"
#include "io/files/json.hpp"
#include "io/files/pending_file.hpp"

namespace clearway::tool {
namespace {

/// Says which labels of a trajectory the output does not keep.
void tell_of_labels(const std::filesystem::path& input, const PoseLabels& labels) {
  const auto left_out = [](const auto& label) { return !label.is_interpolated; };
  const auto has = [&](const auto& label) { return !label.of(labels).empty(); };
  const auto is_lost = [&](const auto& label) { return left_out(label) && has(label); };
  if (names_of_labels(is_lost).empty()) return;
  const std::string kept =
      names_of_labels([&](const auto& label) { return !left_out(label) && has(label); });
  spdlog::info("{}: its {} are left out, as the output has matrices {}only", input.string(),
               names_of_labels(left_out), kept.empty() ? "" : "and " + kept + " ");
}

}  // namespace

void add_pose_options(CLI::App& command, PoseCommand& options, const char* input,
                      const char* output, const std::function<void()>& add_own) {
  add_file(command, "IN", options.input, input)->required();
  add_file(command, "-o,--output", options.output, output)->required();
  add_own();
  command.add_flag("--force", options.force, "Overwrite an existing output");
  command.add_flag("--json", options.json, "One JSON object on standard output");
}

void write_output(const PoseCommand& options,
                  const std::function<WrittenPoses(const std::filesystem::path& file)>& write) {
  PendingFile output(options.output, options.force);
  const WrittenPoses written = write(output.partial());
  output.publish();
  if (written.is_answer && !options.json) return print(written.sentence + "\n");
  spdlog::info("{}: {}", options.output.string(), written.sentence);
  if (options.json) print(indented_text(written.report));
}

void refuse_overwriting_inputs(const PoseCommand& options,
                               std::vector<std::filesystem::path> further) {
  further.insert(further.begin(), options.input);
  further.push_back(options.environment);
  refuse_overwriting(options.output, further);
}

void add_remarks(nlohmann::ordered_json& out, const std::vector<Message>& remarks) {
  using enum Message::Severity;
  for (const auto& [key, severity] : {std::pair{"notes", kNote}, {"warnings", kWarning}}) {
    out[key] = Json::array();
    for (const Message& remark : remarks) {
      if (remark.severity == severity) out[key].push_back(remark);
    }
  }
}

std::optional<Store> take_environment(PoseCommand& options) {
  if (options.environment.empty()) return {};
  Store store(options.environment);
  if (const auto warning = options.lengths.convert_for(store)) log_message(*warning);
  set_environment_unit(store, options.trajectory);
  options.trajectory.default_crs = store.crs_wkt();
  options.unit = symbol_of_unit(store.length_unit());
  return store;
}

TrajectoryFile read_path(const PoseCommand& options) {
  TrajectoryFile path = read_trajectory_file(options.input, options.trajectory);
  for (const Message& remark : path.remarks) log_message(remark);
  tell_of_labels(options.input, path.labels);
  return path;
}

PoseLabels labels_at(const std::vector<double>& places, const PoseLabels& given) {
  return made_labels(given, [&](const std::vector<double>& values) {
    std::vector<double> out;
    for (const double place : places) {
      const auto i = static_cast<std::size_t>(place);
      const double part = place - static_cast<double>(i);
      out.push_back(part > 0 ? values[i] + part * (values[i + 1] - values[i]) : values[i]);
    }
    return out;
  });
}

void write_poses(const std::vector<Pose>& poses, const PoseLabels& labels,
                 const TrajectoryFile& given, const std::filesystem::path& path,
                 std::span<const std::uint32_t> path_pose) {
  const File file = File::create(path);
  const TrajectoryColumns columns{.path_pose = path_pose,
                                  .unit = given.own_unit(),
                                  .metres_per_unit = given.metres_per_unit,
                                  .remarks = given.remarks};
  ConsoleProgress progress;
  if (has_labels(labels) || columns.names_unit() || !path_pose.empty()) {
    write_trajectory_table(poses, labels, columns, file, progress);
  } else {
    write_trajectory(poses, file, progress, labels.made_by, given.remarks);
  }
}

void add_trajectory(CLI::App& program) {
  CLI::App* command =
      program.add_subcommand("trajectory",
                             "Say what is in a trajectory, make it denser or "
                             "sparser, follow it, make one of an alignment or a line");
  command->require_subcommand(1);
  add_trajectory_info(*command);
  add_trajectory_changes(*command);
  add_trajectory_follow(*command);
  add_trajectory_alignment(*command);
  add_trajectory_line(*command);
}

}  // namespace clearway::tool
