#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "campaign/plan.hpp"
#include "io/files/file.hpp"

namespace clearway::campaign {

/// Size and time of an input that a task reads. A task's state keeps them, so that anyone who looks
/// at a result can see that it belongs to an earlier file, without reading the file.
struct InputStamp {
  std::string what;  ///< "model", "trajectory", "vehicle" or "environment"
  std::string file;
  std::uint64_t bytes = 0;
  /// Time of the last modification in nanoseconds, as the file system counts it; where several
  /// files are read (files_behind()), a hash of their names, sizes and times.
  std::int64_t modified = 0;
  friend bool operator==(const InputStamp&, const InputStamp&) = default;
};

/// Stamps of all files that the task's run reads, as they are now; for a vehicle also those of the
/// files that its file names. Missing files are left out.
std::vector<InputStamp> stamps_of(const Task& task);

/// Names the files that changed, for example "the model file truck.ply changed since this run";
/// empty where no file did. A missing file has not been replaced, so it does not count.
std::string changed_since(const std::vector<InputStamp>& stamps);

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
  /// The files that the task read, as they were when it began.
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
/// place with pose and chainage, codes and texts of the warnings. Throws ResourceError where the
/// file is cut short.
nlohmann::ordered_json task_facts(const std::filesystem::path& run_json);

/// Adds the number of conflicts to the facts, where one of the outputs in the folder is their table
/// in CSV; and what the ledger of the task says, where it has one: rows and conflicts by status,
/// `conflicts`, `accepted_conflicts` and the verdict `outside` of these.
void add_conflicts(nlohmann::ordered_json& facts, const std::filesystem::path& folder,
                   const Task& task);

/// What can be said about a task. kBegun: another process works on it, or it was interrupted; the
/// file system has no locks that show which. kOutdated: it finished, but a file that it read has
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

/// What is known of a run, as the page, `campaign status` and `campaign run` count it. Each run has
/// exactly one of these.
enum class Outcome {
  kConflict,
  kUndecided,  ///< a collision is neither certain nor excluded, or the question is in doubt
  kClearWithWarnings,
  kClear,
  kFailed,
  kUnfinished
};
inline constexpr std::array kOutcomes{
    Outcome::kConflict, Outcome::kUndecided, Outcome::kClearWithWarnings,
    Outcome::kClear,    Outcome::kFailed,    Outcome::kUnfinished};

struct OutcomeWords {
  /// The name in JSON, and as a class of the style sheet, for example "not_done".
  const char* name;
  /// A character that shows the outcome without colour.
  const char* sign;
  /// The word after a count, for example "clear with warnings".
  const char* word;
  /// The text of the legend, which says what the outcome means.
  const char* words;
};
const OutcomeWords& words_of(Outcome outcome);

Outcome outcome_of(const TaskLook& look);
/// The outcome without the conflicts that the ledger of the run accepts.
Outcome outcome_outside(const TaskLook& look);

/// The tasks of a plan that are runs, not shards, with their state. A run one of whose shards has
/// failed has failed itself.
struct RunLooks {
  Plan plan;
  std::vector<TaskLook> looks;
};
RunLooks run_looks(const Plan& plan, const std::vector<TaskLook>& looks);

/// How many runs have each outcome, in the order of kOutcomes. The counts add up to the number of
/// runs.
class OutcomeCounts {
 public:
  /// looks: those of run_looks().
  explicit OutcomeCounts(const std::vector<TaskLook>& looks);

  std::size_t of(Outcome outcome) const { return counts_.at(static_cast<std::size_t>(outcome)); }
  std::size_t all() const;
  /// For example "5 runs: 1 conflict, 1 undecided, 1 clear with warnings, 1 clear, 1 failed, 0 not
  /// done".
  std::string text() const;
  /// An object with the counts under the names of the outcomes.
  nlohmann::ordered_json json() const;

 private:
  std::array<std::size_t, kOutcomes.size()> counts_{};
};

/// What has to be said besides the verdict of a run that is done, for example "2 warnings
/// (out-of-reach, scan-ends); 1,234 points ignored, of which 56 would collide; not exact". Empty
/// where there is nothing to say. unit: the unit of lengths, for example "m".
std::string caveats_of(const nlohmann::ordered_json& facts, const std::string& unit);

/// The statuses of ledgers with their numbers, such as "2 accepted, 1 gone"; empty where nothing is
/// in them, and without a ledger. ledger: the member of the facts, or a sum of several.
std::string ledger_words(const nlohmann::ordered_json& ledger);
/// The sums of rows and conflicts by status over all runs; null where no run has a ledger.
nlohmann::ordered_json ledgers_of(const std::vector<TaskLook>& looks);

/// Whether a run is undecided because its question is in doubt, so that its distances say nothing.
bool is_in_doubt(const nlohmann::ordered_json& facts);

/// Why a run is undecided, and on how much of the path nobody knows what is there: "points are
/// near, the question is in doubt (model-unit), not scanned on 3.2 m". Empty where nothing of this
/// holds.
std::string open_words(const nlohmann::ordered_json& facts, const std::string& unit);

/// For example "1,234 points ignored, of which 56 would collide"; empty where none is ignored.
std::string ignored_words(const nlohmann::ordered_json& facts);
/// For example "1,234 below 0.3 m not judged"; empty without a floor.
std::string floor_clause(const nlohmann::ordered_json& facts, const std::string& unit);

}  // namespace clearway::campaign
