#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "campaign/plan.hpp"
#include "campaign/state_file.hpp"
#include "io/system/file.hpp"

namespace clearway::campaign {

/// What can be said about a task. kBegun: another process works on it, or it was interrupted; the
/// file system has no locks that tell which. kOutdated: it finished, but a file that it read has
/// changed since, so its verdict is about an earlier file.
enum class TaskStatus { kDone, kRunning, kBegun, kInterrupted, kOutdated, kFailed, kMissing };
inline constexpr TaskStatus kStatuses[]{
    TaskStatus::kDone,     TaskStatus::kRunning, TaskStatus::kBegun,  TaskStatus::kInterrupted,
    TaskStatus::kOutdated, TaskStatus::kFailed,  TaskStatus::kMissing};
const char* name_of(TaskStatus status);

/// What a task's folder says about it.
struct TaskLook {
  TaskStatus status = TaskStatus::kMissing;
  std::optional<TaskState> state;  ///< state of the last try with this plan
  /// The shard that this describes where it stands for its run; 0 for none.
  std::uint32_t shard = 0;
  /// Which files changed, if the task is outdated: see changed_since().
  std::string changed = {};
};

/// Looks at a task without changing anything. campaign: the campaign's folder.
TaskLook look_at(const Task& task, const std::filesystem::path& campaign);

/// Whether the task's result exists, is complete, and answers the task's question.
bool has_result(const Task& task, const std::filesystem::path& campaign);

/// Whether a task is done: a try with this plan says so, the result is complete and answers the
/// task's question, the outputs exist, and no file that the try read has changed since. A shard is
/// also done where its run has the result, because the shard is not needed then.
bool is_done(const Task& task, const std::filesystem::path& campaign,
             const std::optional<TaskState>& state);

/// Whether another try may help. After a failure it may only where the exit code is 4, or where an
/// input was not the planned one, which may have been put back; so not after a crash.
bool may_succeed(const TaskLook& look);

/// The file in the task's folder that a process holds locked while it works on the task.
inline constexpr const char* kLockName = "lock";

}  // namespace clearway::campaign
