#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "campaign/plan.hpp"
#include "io/files/json.hpp"

namespace clearway::campaign {

/// Size and time of an input that a task reads. A task's state keeps them, so that anyone who looks
/// at a result can see that it belongs to an earlier file, without reading the file.
struct InputStamp : TaskInput {
  std::uint64_t bytes = 0;
  /// Time of the last modification in nanoseconds, as the file system counts it; where several
  /// files are read (files_behind()), a hash of their names, sizes and times.
  std::uint64_t modified = 0;
  friend bool operator==(const InputStamp&, const InputStamp&) = default;
};

/// Stamps of all files that the task's run reads, as they are now; for a vehicle also those of the
/// files that its file names. Missing files are left out.
std::vector<InputStamp> stamps_of(const Task& task);

/// Names the files that changed, for example "the model file truck.ply changed since this run";
/// empty where no file did. A missing file has not been replaced, so it does not count.
std::string changed_since(const std::vector<InputStamp>& stamps);

/// What can be said about a task. kBegun: another process works on it, or it was interrupted; the
/// file system has no locks that show which. kOutdated: it finished, but a file that it read has
/// changed since, so its verdict is about an earlier file.
enum class Status { kDone, kRunning, kBegun, kInterrupted, kOutdated, kFailed, kMissing };
inline constexpr Status kStatuses[]{Status::kDone,        Status::kRunning,  Status::kBegun,
                                    Status::kInterrupted, Status::kOutdated, Status::kFailed,
                                    Status::kMissing};
const char* name_of(Status status);

/// The contents of state.json in the folder of a task.
// NOLINTNEXTLINE(bugprone-exception-escape): of JSON that is moved
struct TaskState {
  /// How far the last try came: kBegun, kDone, kInterrupted or kFailed.
  Status ending = Status::kBegun;
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
  /// The files that the task read, as they were when it began.
  std::vector<InputStamp> inputs;
  Json facts;  ///< facts about the result once the task is done: see task_facts()
  friend bool operator==(const TaskState&, const TaskState&) = default;
};

/// The state in a folder. Nothing where there is none, or none that can be read, since a crash of
/// the system may cut the file short.
std::optional<TaskState> read_state(const std::filesystem::path& folder);

void write_state(const std::filesystem::path& folder, const TaskState& state);

/// The facts about a result, from what the commands of the task printed. Of the run: verdict and
/// its reasons, colliding_points, ignored points (null where the query ignores none), least
/// distance and first place with pose and chainage, codes and texts of the warnings. Of the
/// conflicts: their number, and with a ledger its rows and conflicts by status, `conflicts`,
/// `accepted_conflicts` and the verdict `outside` of these. Throws ResourceError where a file is
/// cut short.
Json task_facts(const Task& task, const std::filesystem::path& folder);

/// What a task's folder says about it.
struct TaskStatus {
  const Task* task = nullptr;  ///< in the plan
  Status status = Status::kMissing;
  std::optional<TaskState> state = {};  ///< state of the last try with this plan
  /// The shard that this describes where it stands for its run; 0 for none.
  std::uint32_t shard = 0;
  /// Which files changed, if the task is outdated: see changed_since().
  std::string changed = {};

  /// The facts about the result; null where it is not done, and may be for a shard whose run is.
  const Json& facts() const;
};

/// What can be said about a task without changing anything. campaign: the campaign's folder.
TaskStatus status_of(const Task& task, const std::filesystem::path& campaign);

/// Whether the task's result exists, is complete, and answers the task's question.
bool has_result(const Task& task, const std::filesystem::path& campaign);

/// Whether a task is done: a try with this plan says so, the result is complete and answers the
/// task's question, the outputs exist, and no file that the try read has changed since. A shard is
/// also done where its run has the result, because the shard is not needed then.
bool is_done(const Task& task, const std::filesystem::path& campaign,
             const std::optional<TaskState>& state);

/// Whether another try may help. After a failure it may only where the exit code is 4, or where an
/// input was not the planned one, which may have been put back; so not after a crash.
bool may_succeed(const TaskStatus& status);

/// The file in the task's folder that a process holds locked while it works on the task.
inline constexpr const char* kLockName = "lock";

/// The tasks of a plan that are runs, not shards. A run one of whose shards has failed has failed
/// itself.
std::vector<TaskStatus> runs_of(const std::vector<TaskStatus>& tasks);

}  // namespace clearway::campaign
