#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "campaign/plan.hpp"
#include "campaign/state_file.hpp"
#include "io/system/file.hpp"

namespace clearway::campaign {

/// kBegun: by another process, or interrupted; the file system has no locks that tell. kOutdated:
/// finished, but a file that it read has changed since, so that its verdict is of an earlier file.
enum class TaskStatus { kDone, kRunning, kBegun, kInterrupted, kOutdated, kFailed, kMissing };
inline constexpr TaskStatus kStatuses[]{
    TaskStatus::kDone,     TaskStatus::kRunning, TaskStatus::kBegun,  TaskStatus::kInterrupted,
    TaskStatus::kOutdated, TaskStatus::kFailed,  TaskStatus::kMissing};
const char* name_of(TaskStatus status);

/// A task as its folder says.
struct TaskLook {
  TaskStatus status = TaskStatus::kMissing;
  std::optional<TaskState> state;  ///< of the last try of this plan
  std::uint32_t shard = 0;         ///< whose look it is, where it stands for its run; 0: of none
  std::string changed = {};        ///< of an outdated one: see changed_since()
};

/// campaign: its folder. Changes nothing.
TaskLook look_at(const Task& task, const std::filesystem::path& campaign);

/// Whether the result is there, complete, and answers the task's question.
bool has_result(const Task& task, const std::filesystem::path& campaign);

/// Whether a try said so of this plan, and the result is complete and answers the task's question,
/// and the outputs are there, and no file that the try read has changed since. A shard is done too
/// where its run has the result: it is not needed.
bool is_done(const Task& task, const std::filesystem::path& campaign,
             const std::optional<TaskState>& state);

/// Whether another try may help: not after a crash, and after exit codes 2 and 3 only where an
/// input was not the planned one, which may have been put back.
bool may_succeed(const TaskLook& look);

/// What a process at work on the task holds locked, in the run's folder.
inline constexpr const char* kLockName = "lock";

}  // namespace clearway::campaign
