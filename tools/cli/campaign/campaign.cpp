#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "campaign/outcome.hpp"
#include "campaign/plan.hpp"
#include "campaign/task_state.hpp"
#include "clearway/error.hpp"
#include "cli/campaign/commands.hpp"
#include "cli/commands.hpp"
#include "cli/steps.hpp"
#include "cli/support/console.hpp"
#include "cli/support/program.hpp"
#include "core/util/format.hpp"
#include "io/files/json.hpp"
#include "io/files/pending_file.hpp"
#include "report/page.hpp"

namespace clearway::tool {
namespace {

using campaign::Outcome;
using campaign::Plan;
using campaign::Status;
using campaign::TaskList;
using campaign::TaskStatus;

constexpr const char* kPageName = "index.html";

/// The options of the commands on a campaign that is planned.
struct CampaignOptions {
  std::filesystem::path folder;
  std::optional<std::string> tasks;
  std::string date;
  bool all = false, fail_on_collision = false, missing = false, failed = false;
  bool json = false, force = false;
  int jobs = 1;
};

std::vector<TaskStatus> statuses_of(const Plan& plan, const std::filesystem::path& folder) {
  std::vector<TaskStatus> statuses;
  for (const campaign::Task& task : plan.tasks) {
    if (stop_requested()) throw Interrupted("");
    statuses.push_back(campaign::status_of(task, folder));
  }
  return statuses;
}

// clearway campaign run

Plan plan_to_run(const CampaignOptions& options) {
  if (options.all) return campaign::read_plan(options.folder);
  if (!options.tasks) throw UsageError("expected --task with numbers, or --all");
  const std::optional<TaskList> tasks = campaign::parse_task_list(*options.tasks);
  if (!tasks) {
    throw UsageError("--task: " + *options.tasks + ": expected numbers from 0, such as 3,7-9");
  }
  // What `campaign status --missing` prints where nothing is missing.
  if (tasks->empty()) spdlog::info("nothing to do, because the list of tasks is empty");
  return campaign::read_plan(options.folder, tasks);
}

int run_tasks(const CampaignOptions& options) {
  const Plan plan = plan_to_run(options);
  const auto folder = std::filesystem::absolute(options.folder).lexically_normal();
  const int code = do_tasks(plan, folder, options.jobs, options.all);
  // Those that were done before are counted too.
  const std::vector<TaskStatus> runs = campaign::runs_of(statuses_of(plan, folder));
  if (!runs.empty()) spdlog::info("{}: {}", plan.name, campaign::counts_text(runs));
  const std::string ledgers = campaign::ledger_words(campaign::ledgers_of(runs));
  if (!ledgers.empty()) spdlog::info("{}: ledgers: {}", plan.name, ledgers);
  if (code != kDone || !options.fail_on_collision) return code;
  const auto ends_as = [&](Outcome outcome) {
    return std::ranges::count(runs, outcome, campaign::outcome_outside) > 0;
  };
  if (ends_as(Outcome::kConflict)) return kDiffers;
  return ends_as(Outcome::kUndecided) ? int{kUndecided} : code;
}

// clearway campaign status

/// The tasks that another try may finish; with `failed`, those that failed and that no further try
/// would finish.
TaskList tasks_to_do(const std::vector<TaskStatus>& statuses, bool failed) {
  TaskList tasks;
  for (const TaskStatus& task : statuses) {
    const bool to_do = task.status != Status::kDone && task.status != Status::kRunning &&
                       task.status != Status::kBegun;
    if (to_do && campaign::may_succeed(task) != failed) tasks.push_back(task.task->number);
  }
  return tasks;
}

std::size_t count_of(const std::vector<TaskStatus>& statuses, Status status) {
  return static_cast<std::size_t>(std::ranges::count(statuses, status, &TaskStatus::status));
}

Json json_of(const TaskStatus& task) {
  Json out{{"task", task.task->number},
           {"name", task.task->name()},
           {"folder", task.task->folder().string()},
           {"status", campaign::name_of(task.status)}};
  if (!task.changed.empty()) out["changed"] = task.changed;
  if (const auto& state = task.state) {
    out["exit_code"] = state->exit_code;
    out["message"] = state->message;
    out["tries"] = state->tries;
    out["seconds"] = state->seconds;
    out["host"] = state->host;
    out["time"] = state->time;
  }
  const Json& facts = task.facts();
  if (facts.is_null()) return out;
  for (const char* key :
       {"verdict", "reasons", "doubts", "colliding_points", "ignored", "floor", "warnings"}) {
    out[key] = facts.value(key, Json());
  }
  if (facts.contains("ledger")) out["ledger"] = facts["ledger"];
  return out;
}

Json status_json(const Plan& plan, const std::vector<TaskStatus>& statuses) {
  const std::vector<TaskStatus> runs = campaign::runs_of(statuses);
  Json out{{"campaign", plan.name}, {"tasks", plan.tasks.size()}};
  for (const Status status : campaign::kStatuses) {
    out[campaign::name_of(status)] = count_of(statuses, status);
  }
  out["runs"] = runs.size();
  out["outcomes"] = campaign::counts_json(runs);
  if (const Json ledgers = campaign::ledgers_of(runs); !ledgers.is_null()) out["ledgers"] = ledgers;
  out["list"] = Json::array();
  for (const TaskStatus& task : statuses) out["list"].push_back(json_of(task));
  return out;
}

std::string numbered(const campaign::Task& task) {
  return fmt::format("task {}, {}", task.number, task.name());
}

/// Verdicts with their caveats, each once with its tasks, in lines.
std::string caveats_text(const Plan& plan, const std::vector<TaskStatus>& statuses) {
  std::map<std::string, TaskList> tasks_of;
  for (const TaskStatus& task : statuses) {
    if (task.facts().is_null()) continue;
    const std::string caveats = campaign::caveats_of(task.facts(), task.task->unit);
    const std::string word = campaign::words_of(campaign::outcome_of(task)).word;
    if (!caveats.empty()) tasks_of[word + "; " + caveats].push_back(task.task->number);
  }
  std::string text;
  for (const auto& [words, tasks] : tasks_of) {
    text += (tasks.size() == 1 ? numbered(plan.tasks[tasks[0]])
                               : "tasks " + campaign::task_list_text(tasks)) +
            ": " + words + "\n";
  }
  return text;
}

std::string status_text(const Plan& plan, const std::vector<TaskStatus>& statuses) {
  const std::vector<TaskStatus> runs = campaign::runs_of(statuses);
  std::string text = fmt::format("{}: {}\n", plan.name, counted(plan.tasks.size(), "task"));
  for (const Status status : campaign::kStatuses) {
    const std::size_t count = count_of(statuses, status);
    if (count == 0 && (status == Status::kBegun || status == Status::kOutdated)) continue;
    text += fmt::format("  {:<12}{:>7}\n", campaign::name_of(status), format_count(count));
  }
  text += campaign::counts_text(runs) + "\n";
  const std::string ledgers = campaign::ledger_words(campaign::ledgers_of(runs));
  if (!ledgers.empty()) text += "ledgers: " + ledgers + "\n";
  text += caveats_text(plan, statuses);
  for (const TaskStatus& task : statuses) {
    if (task.status == Status::kOutdated) {
      text += fmt::format("{}: {}, so its verdict is of an earlier file; run it again\n",
                          numbered(*task.task), task.changed);
    } else if (task.status == Status::kFailed) {
      text += fmt::format("{}: exit code {}: {}\n", numbered(*task.task), task.state->exit_code,
                          task.state->message);
    }
  }
  return text;
}

void run_status(const CampaignOptions& options) {
  const Plan plan = campaign::read_plan(options.folder);
  const std::vector<TaskStatus> statuses = statuses_of(plan, options.folder);
  if (options.missing || options.failed) {
    const TaskList tasks = tasks_to_do(statuses, options.failed);
    return print(tasks.empty() ? "" : campaign::task_list_text(tasks) + "\n");
  }
  print(options.json ? indented_text(status_json(plan, statuses)) : status_text(plan, statuses));
}

// clearway campaign report

void write_campaign_page(CampaignOptions& options) {
  const std::filesystem::path file = options.folder / kPageName;
  const Plan plan = campaign::read_plan(options.folder);
  PendingFile pending(file, options.force);
  if (options.date.empty()) options.date = now_in_utc();
  const std::vector<TaskStatus> runs = campaign::runs_of(statuses_of(plan, options.folder));
  const Json facts = campaign::report_facts(plan, runs, options.date);
  PageTexts texts;
  texts.date = options.date;
  Json page = page_head(texts, plan.name);
  page.update(facts);
  page["words"] = campaign::report_words(runs);
  write_page(pending.partial(), kCampaignPage, {.title = plan.name, .facts = page_text(page)});
  pending.publish();
  spdlog::info("{}: {}", file.string(), campaign::counts_text(runs));
  if (options.json) print(indented_text(facts));
}

/// Adds a command on the folder of a campaign.
CLI::App* add_command(CLI::App& campaign, const char* name, const char* description,
                      CampaignOptions& options) {
  CLI::App* command = campaign.add_subcommand(name, description);
  command->add_option("DIR", options.folder, "Folder of the campaign")
      ->type_name("DIR")
      ->required();
  return command;
}

void add_campaign_run(CLI::App& campaign, int& exit_code) {
  const auto options = std::make_shared<CampaignOptions>();
  CLI::App* command = add_command(campaign, "run",
                                  "Do tasks of a campaign; finished ones return at once", *options);
  CLI::Option* tasks =
      command->add_option("--task", options->tasks, "Numbers of tasks, from 0, for example 3,7-9");
  tasks->type_name("N,...");
  command->add_flag("--all", options->all, "All tasks that are not done")->excludes(tasks);
  command->add_flag("--fail-on-collision", options->fail_on_collision,
                    "Exit with code 1 where a run finds a conflict, and with 6 where none does and "
                    "one is undecided; what ledgers accept does not count");
  command->add_option("--jobs", options->jobs, "Tasks at the same time; they share the cores")
      ->type_name("N")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  command->footer(
      "Each command of a task is a process of its own; plan.json has its words. An interrupted "
      "task\n"
      "resumes. The exit code is that of the task, or the first of 5, 4, 3, 2, 1 and 6 with which\n"
      "one of several ended; 1 and 6 are verdicts, which count only with --fail-on-collision.\n"
      "With --all, interrupted tasks (5) are queued again, and those that failed for the "
      "machine's\n"
      "sake (4) at most twice.\n"
      "Example: clearway campaign run spring --all --jobs 2");
  command->callback([options, &exit_code] { exit_code = run_tasks(*options); });
}

void add_campaign_status(CLI::App& campaign) {
  const auto options = std::make_shared<CampaignOptions>();
  CLI::App* command = add_command(
      campaign, "status",
      "Say which tasks are done, running, interrupted, outdated, failed or missing, and what the "
      "runs found",
      *options);
  CLI::Option* json = command->add_flag("--json", options->json, "Print one JSON object");
  CLI::Option* missing = command->add_flag(
      "--missing", options->missing,
      "Print the numbers of the tasks that are still to be done, for sbatch --array");
  missing->excludes(json);
  command
      ->add_flag("--failed", options->failed,
                 "Print the numbers of the tasks that would fail again")
      ->excludes(json)
      ->excludes(missing);
  command->footer(
      "A task is done when its result is complete, answers the planned question, and its outputs "
      "are\n"
      "there. It is outdated where a file that it read has changed since; run does it again. A\n"
      "running task counts as neither missing nor failed.\n"
      "Example: clearway campaign status spring --missing");
  command->callback([options] { run_status(*options); });
}

void add_campaign_report(CLI::App& campaign) {
  const auto options = std::make_shared<CampaignOptions>();
  CLI::App* command = add_command(
      campaign, "report", "Write a page with the verdicts of all tasks: index.html in the folder",
      *options);
  command->add_option("--date", options->date, "Date on the page (default: now, in UTC)")
      ->type_name("TEXT");
  command->add_flag("--force", options->force, "Overwrite an existing page");
  command->add_flag("--json", options->json, "Print what the page says as one JSON object");
  command->footer(
      "Vehicles and routes make a table for each radius. A task that is not done is shown as "
      "such.\n"
      "Example: clearway campaign report spring");
  command->callback([options] {
    run_stoppable(options->folder / kPageName, kStartsAgain,
                  [&] { write_campaign_page(*options); });
  });
}

}  // namespace

void add_campaign(CLI::App& program, int& exit_code) {
  CLI::App* command = program.add_subcommand(
      "campaign", "Ask many questions: each vehicle on each route, here or on a cluster");
  command->require_subcommand(1);
  add_campaign_plan(*command);
  add_campaign_run(*command, exit_code);
  add_campaign_status(*command);
  add_campaign_report(*command);
}

}  // namespace clearway::tool
