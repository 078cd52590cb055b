#include "campaign/task_state.hpp"

#include <algorithm>

#include "campaign/question.hpp"
#include "clearway/error.hpp"
#include "io/system/file_lock.hpp"

namespace clearway::campaign {
namespace {

namespace fs = std::filesystem;

LockState task_lock(const fs::path& folder) {
  std::error_code unknown;
  if (!fs::exists(folder / kLockName, unknown)) return LockState::kFree;
  try {
    return lock_state(File::open_for_reading(folder / kLockName));
  } catch (const ResourceError&) {
    return LockState::kUnknown;
  }
}

/// The state of the last try, where it has the plan's question, whatever its outputs.
std::optional<TaskState> state_of(const Task& task, const fs::path& folder) {
  std::optional<TaskState> state = read_state(folder);
  if (state && state->question_id != task.question_id()) state.reset();
  return state;
}

TaskStatus status_of(const std::optional<TaskState>& state, LockState lock) {
  if (lock == LockState::kHeld) return TaskStatus::kRunning;
  if (!state) return TaskStatus::kMissing;
  switch (state->ending) {
    case Ending::kFailed:
      return TaskStatus::kFailed;
    case Ending::kBegun:
      return lock == LockState::kUnknown ? TaskStatus::kBegun : TaskStatus::kInterrupted;
    default:
      return TaskStatus::kInterrupted;  // done, but outputs are missing or of another plan
  }
}

/// Whether the try finished its task, even if its inputs have changed since.
bool is_finished(const Task& task, const fs::path& campaign,
                 const std::optional<TaskState>& state) {
  if (!state || state->ending != Ending::kDone || state->question_id != task.question_id() ||
      state->outputs_id != task.outputs_id) {
    return false;
  }
  const fs::path folder = campaign / task.folder();
  std::error_code unknown;
  return std::ranges::all_of(
             task.outputs, [&](const auto& name) { return fs::exists(folder / name, unknown); }) &&
         has_result(task, campaign);
}

}  // namespace

const char* name_of(TaskStatus status) {
  constexpr const char* kNames[]{"done",     "running", "begun",  "interrupted",
                                 "outdated", "failed",  "missing"};
  return kNames[static_cast<std::size_t>(status)];
}

bool has_result(const Task& task, const fs::path& campaign) {
  return answers(campaign / task.folder() / task.result(), task.question);
}

bool is_done(const Task& task, const fs::path& campaign, const std::optional<TaskState>& state) {
  if (task.shard && has_result(run_of(task), campaign)) return true;
  return is_finished(task, campaign, state) && changed_since(state->inputs).empty();
}

TaskLook look_at(const Task& task, const fs::path& campaign) {
  const fs::path folder = campaign / task.folder();
  std::optional<TaskState> state = state_of(task, folder);
  for (;;) {
    if (is_done(task, campaign, state)) return {TaskStatus::kDone, state};
    const LockState lock = task_lock(folder);
    if (lock == LockState::kHeld) return {TaskStatus::kRunning, state};
    // The process that held the lock may have ended, or another may have begun, between the two
    // looks.
    std::optional<TaskState> again = state_of(task, folder);
    if (again == state) {
      TaskLook look{status_of(state, lock), state};
      if (is_finished(task, campaign, state)) {
        look.status = TaskStatus::kOutdated;
        look.changed = changed_since(state->inputs);
      }
      return look;
    }
    state = std::move(again);
  }
}

bool may_succeed(const TaskLook& look) {
  constexpr int kResource = 4;
  if (look.status != TaskStatus::kFailed) return true;
  return look.state->exit_code == kResource || look.state->inputs_changed;
}

}  // namespace clearway::campaign
