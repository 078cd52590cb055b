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

/// state.json in the folder of a run.
// NOLINTNEXTLINE(bugprone-exception-escape): of JSON that is moved
struct TaskState {
  Ending ending = Ending::kBegun;
  std::string question_id, outputs_id;  ///< of the plan that it was tried by
  int exit_code = 0;
  std::string message;  ///< what the program said last; empty where all went well
  std::uint64_t tries = 0;
  double seconds = 0;      ///< of the last try
  std::string host, time;  ///< of its end, in UTC
  /// Whether it failed because an input is not the planned one: another try succeeds once it is.
  bool inputs_changed = false;
  /// The files that it read, as they were when it began. Empty in states of earlier releases.
  std::vector<InputStamp> inputs = {};
  nlohmann::ordered_json facts;  ///< of the result, once it is done: see task_facts()
  friend bool operator==(const TaskState&, const TaskState&) = default;
};

/// Nothing where there is none, or none that can be read: a crash of the system may cut it.
std::optional<TaskState> read_state(const std::filesystem::path& folder);

void write_state(const std::filesystem::path& folder, const TaskState& state);

/// Of what clearway run --json printed: verdict and its reasons, colliding_points, ignored points
/// (null where the query ignores none), least distance and first place with pose and chainage, and
/// codes and texts of the warnings; and of the task's question whether it asks for an exact answer.
/// Throws ResourceError where the file is cut.
nlohmann::ordered_json task_facts(const std::filesystem::path& run_json,
                                  const nlohmann::ordered_json& question);

}  // namespace clearway::campaign
