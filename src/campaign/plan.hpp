#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "campaign/campaign_file.hpp"
#include "clearway/shard.hpp"
#include "io/files/json.hpp"
#include "io/result/result.hpp"

namespace clearway::campaign {

/// The parameters of a query that are one value, as far as is_listed() says.
Json parameters_json(const QueryParameters& query);

/// What distinguishes the questions that results answer: parameters, and sizes and hashes of the
/// inputs; for a part also which part it is, and of which store.
Json question_of(const ResultHeader& header);

/// The question that a complete result or part answers, whose rows are not read; null where there
/// is no such file.
Json question_in(const std::filesystem::path& file);

/// Whether the file is the journal of a run with another model or trajectory.
bool is_journal_of_others(const std::filesystem::path& file, const Json& question);

/// One command line of a task, without the program's name. Names such as "out.h5" are relative to
/// the task's folder.
using Command = std::vector<std::string>;

inline constexpr const char* kResultName = "out.h5";
inline constexpr const char* kPartName = "part.h5";  ///< the result of a shard
inline constexpr const char* kReportName = "report.html";

/// The file of the task's folder that gets what a command prints: its report as JSON. Empty for a
/// command that prints none.
std::string output_of(const Command& command);

/// A file that a task reads.
struct TaskInput {
  std::string what;  ///< "environment", "model", "vehicle" or "trajectory"
  std::string file;
  friend bool operator==(const TaskInput&, const TaskInput&) = default;
};

/// What one process does: a run and its outputs, a shard of a run, or, for a run that is divided,
/// the merge of its shards and the outputs.
// NOLINTNEXTLINE(bugprone-exception-escape): of JSON that is moved
struct Task {
  std::size_t number = 0;
  std::string vehicle, route, environment, radius;
  std::string unit;  ///< unit of lengths for people, for example "m"
  Json question;
  std::optional<Shard> shard;  ///< set for a shard
  /// The number of shards that a merge merges, whose tasks come directly before it; 0 for other
  /// tasks.
  std::uint32_t shards = 0;
  /// The fingerprint of the store whose points a merge's shards search.
  std::string store;
  std::vector<TaskInput> inputs;
  std::string ledger;                ///< the table of its ledger; empty: none
  std::vector<std::string> outputs;  ///< names of the files beside the result
  std::vector<Command> commands;     ///< the first command makes the result
  /// Identifies how the outputs are made, whatever the limits.
  std::string outputs_id;

  /// The task's name, which is also its folder below the campaign's "runs", for example
  /// "truck/north/0.1" or "truck/north/0.1/shards/2".
  std::string name() const {
    return vehicle + "/" + route + "/" + radius +
           (shard ? "/shards/" + std::to_string(shard->number) : "");
  }
  std::filesystem::path folder() const { return std::filesystem::path("runs") / name(); }
  const char* result() const { return shard ? kPartName : kResultName; }
  std::string question_id() const;
};

struct Plan {
  std::string name;
  std::vector<Task> tasks;
};

/// The task of one of the shards that a merge waits for, without its number and its `clearway run`.
/// number: the shard's, from 1.
Task shard_of(const Task& merge, std::uint32_t number);

/// A run of the campaign with the command lines that ask for it.
struct PlannedRun {
  const Entry& vehicle;
  const Entry& route;
  const Entry& environment;
  Arguments arguments;  ///< of all its commands
  Arguments limits;
  /// The commands that make the outputs, and the words that each begins with.
  std::vector<std::pair<Commands, Command>> outputs;

  /// The arguments that a command takes, with the keys of campaign.json that messages name.
  Arguments taken_by(unsigned command, bool with_limits = true) const;
};

/// What is known of a run once its inputs are read.
struct RunFacts {
  Json question;
  std::string unit;
  std::uint32_t shards = 1;  ///< number of shards that the run is divided into
  std::string store;         ///< fingerprint of the store, as text
};

/// Plans the tasks of vehicles, routes and radii in the order of the file, radii innermost. The
/// shards of a run come before their merge. facts_of reads what a task would read, and refuses what
/// the task would refuse.
Plan make_plan(const Campaign& campaign,
               const std::function<RunFacts(const PlannedRun&)>& facts_of);

/// Numbers of tasks, ascending.
using TaskList = std::vector<std::size_t>;

/// The numbers as sbatch --array takes them, for example "3,7-9".
std::string task_list_text(const TaskList& tasks);

/// The numbers in a list such as "3,7-9", each once; none in an empty text, and nullopt where the
/// text is not such a list.
std::optional<TaskList> parse_task_list(std::string_view text);

inline constexpr const char* kPlanName = "plan.json";

/// The plan as one JSON object with one line for each task, so that a task can be read without
/// parsing all of them.
std::string plan_text(const Plan& plan);

/// Reads the plan of a campaign's folder: all of its tasks, or those with the numbers in `tasks`,
/// in their order. Throws UsageError where there is no plan or no task with a number, and
/// InputError where the plan is damaged.
Plan read_plan(const std::filesystem::path& folder, const std::optional<TaskList>& tasks = {});

}  // namespace clearway::campaign
