#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "campaign/input_stamp.hpp"

namespace clearway::campaign {

/// How far the last try of a task came.
enum class Ending { kBegun, kDone, kInterrupted, kFailed };

/// The contents of state.json in the folder of a task.
// NOLINTNEXTLINE(bugprone-exception-escape): of JSON that is moved
struct TaskState {
  Ending ending = Ending::kBegun;
  /// The task's ids in the plan by which it was last tried.
  std::string question_id, outputs_id;
  int exit_code = 0;
  /// The last thing that the program said; empty where all went well.
  std::string message;
  std::uint64_t tries = 0;
  double seconds = 0;  ///< duration of the last try
  /// Host of the last try, and the time of its end in UTC.
  std::string host, time;
  /// Whether the task failed because an input is not the planned one. Another try succeeds once the
  /// input is put back.
  bool inputs_changed = false;
  /// The files that the task read, as they were when it began. Empty in states of earlier releases.
  std::vector<InputStamp> inputs = {};
  /// Facts about the result once the task is done: see task_facts().
  nlohmann::ordered_json facts;
  friend bool operator==(const TaskState&, const TaskState&) = default;
};

/// The state in a folder. Nothing where there is none, or none that can be read, since a crash of
/// the system may cut the file short.
std::optional<TaskState> read_state(const std::filesystem::path& folder);

void write_state(const std::filesystem::path& folder, const TaskState& state);

/// The facts about a result, from what `clearway run --json` printed: verdict and its reasons,
/// colliding_points, ignored points (null where the query ignores none), least distance and first
/// place with pose and chainage, codes and texts of the warnings; and from the task's question,
/// whether it asks for an exact answer. Throws ResourceError where the file is cut short.
nlohmann::ordered_json task_facts(const std::filesystem::path& run_json,
                                  const nlohmann::ordered_json& question);

}  // namespace clearway::campaign
