#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "clearway/box.hpp"
#include "clearway/error.hpp"
#include "clearway/pose.hpp"
#include "clearway/store.hpp"
#include "cli/steps.hpp"
#include "cli/support/console.hpp"
#include "core/describe/labels.hpp"
#include "io/paths/trajectory_file.hpp"

/// What the commands of `clearway trajectory` share, and the functions that add them.
namespace clearway::tool {

void add_trajectory_alignment(CLI::App& trajectory);
/// Adds resample, thin and smooth.
void add_trajectory_changes(CLI::App& trajectory);
void add_trajectory_follow(CLI::App& trajectory);
void add_trajectory_info(CLI::App& trajectory);
void add_trajectory_line(CLI::App& trajectory);

/// Adds the options of a command that writes poses: the file that it reads, the one that it writes,
/// its own options, --force and --json.
void add_pose_options(CLI::App& command, PoseCommand& options, const char* input,
                      const char* output, const std::function<void()>& add_own);

/// The texts of a command that writes poses: those of the file that it reads and the one that it
/// writes, too.
struct WriterTexts {
  const char *name, *description, *input, *output, *footer;
};

/// Adds a command that writes poses. add_own(command, options): adds its own options;
/// write(options): does its work, which a signal stops.
template <typename Options, typename AddOwn, typename Write>
void add_writer(CLI::App& trajectory, const WriterTexts& texts, const AddOwn& add_own,
                const Write& write) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = trajectory.add_subcommand(texts.name, texts.description);
  add_pose_options(*command, *options, texts.input, texts.output,
                   [&] { add_own(*command, *options); });
  command->footer(texts.footer);
  command->callback(
      [options, write] { run_stoppable(options->output, kStartsAgain, [&] { write(*options); }); });
}

/// What a command says of the poses that it has written.
struct WrittenPoses {
  std::string sentence;
  nlohmann::ordered_json report;  ///< what --json prints
  /// Whether the sentence goes to standard output where no JSON does, because it is an answer.
  bool is_answer = false;
};

/// Makes the output of a command and reports it. write: writes the file that it is given.
void write_output(const PoseCommand& options,
                  const std::function<WrittenPoses(const std::filesystem::path& file)>& write);

/// Throws UsageError where the output is the input, the store or one of further inputs.
void refuse_overwriting_inputs(const PoseCommand& options,
                               std::vector<std::filesystem::path> further = {});

/// Adds the notes and the warnings, each as a list.
void add_remarks(nlohmann::ordered_json& out, const std::vector<Message>& remarks);

/// Opens the store, if the command has one. Lengths and files without a unit of their own get its
/// unit.
std::optional<Store> take_environment(PoseCommand& options);

/// Reads the given path, and logs what is odd about it and which labels are left out.
TrajectoryFile read_path(const PoseCommand& options);

/// The bounding box of the model. No other place of a mesh is farther out than its vertices.
Box box_of_model(const ChangeCommand& options);

/// The motion_bound() from each pose to the next.
std::vector<double> motions_of(const std::vector<Pose>& poses, const Box& model);

/// Does `work`; an InputError that it throws about the path is given the name of the path's file.
template <typename Work>
auto on_path(const PoseCommand& options, const Work& work) {
  try {
    return work();
  } catch (const InputError& error) {
    throw InputError(options.input.string() + ": " + error.what());
  }
}

/// The labels of a trajectory that is made of a given one: make(values) of each label that such a
/// trajectory keeps and the given one has.
template <typename Make>
PoseLabels made_labels(const PoseLabels& given, const Make& make) {
  PoseLabels out;
  for_each_label([&](const auto& label) {
    if constexpr (!std::decay_t<decltype(label)>::is_text()) {
      const std::vector<double>& values = label.of(given);
      if (label.is_interpolated && !values.empty()) label.of(out) = make(values);
    }
  });
  return out;
}

/// The labels at places of the given path: 3.25 is a quarter of the way from pose 3 to pose 4.
PoseLabels labels_at(const std::vector<double>& places, const PoseLabels& given);

/// Writes poses that are made of a given trajectory: a table where there are labels, a unit or
/// poses of the path to name, and matrices otherwise. Their unit is that of the given file, so that
/// the new one is understood as that was. path_pose: see TrajectoryColumns
void write_poses(const std::vector<Pose>& poses, const PoseLabels& labels,
                 const TrajectoryFile& given, const std::filesystem::path& path,
                 std::span<const std::uint32_t> path_pose = {});

}  // namespace clearway::tool
