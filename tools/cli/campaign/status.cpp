#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "campaign/plan.hpp"
#include "campaign/task_state.hpp"
#include "cli/campaign/commands.hpp"
#include "cli/support/console.hpp"
#include "cli/support/program_json.hpp"
#include "core/util/format.hpp"
#include "io/files/json.hpp"

namespace clearway::tool {
namespace {

using campaign::TaskLook;
using campaign::TaskStatus;

struct CampaignStatusOptions {
  std::filesystem::path folder;
  bool json = false, missing = false, failed = false;
};

std::size_t count_of(const std::vector<TaskLook>& looks, TaskStatus status) {
  return static_cast<std::size_t>(std::ranges::count(looks, status, &TaskLook::status));
}

/// The tasks that another try may finish; with `failed`, those that failed and that no further try
/// would finish.
campaign::TaskList tasks_to_do(const std::vector<TaskLook>& looks, bool failed) {
  campaign::TaskList tasks;
  for (std::size_t i = 0; i < looks.size(); ++i) {
    const TaskStatus status = looks[i].status;
    const bool to_do = status != TaskStatus::kDone && status != TaskStatus::kRunning &&
                       status != TaskStatus::kBegun;
    if (failed ? status == TaskStatus::kFailed && !campaign::may_succeed(looks[i])
               : to_do && campaign::may_succeed(looks[i])) {
      tasks.push_back(i);
    }
  }
  return tasks;
}

/// Whether a task has no facts, as may be for a shard whose run is done.
bool state_is_empty(const TaskLook& look) { return !look.state || look.state->facts.is_null(); }

nlohmann::ordered_json status_json(const campaign::Plan& plan, const std::vector<TaskLook>& looks) {
  nlohmann::ordered_json out{{"campaign", plan.name}, {"tasks", plan.tasks.size()}};
  for (const TaskStatus status : campaign::kStatuses) {
    out[campaign::name_of(status)] = count_of(looks, status);
  }
  const campaign::OutcomeCounts outcomes(campaign::run_looks(plan, looks).looks);
  out["runs"] = outcomes.all();
  out["outcomes"] = outcomes.json();
  const nlohmann::ordered_json ledgers =
      campaign::ledgers_of(campaign::run_looks(plan, looks).looks);
  if (!ledgers.is_null()) out["ledgers"] = ledgers;
  out["list"] = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < looks.size(); ++i) {
    nlohmann::ordered_json one{{"task", i},
                               {"name", plan.tasks[i].name()},
                               {"folder", plan.tasks[i].folder().string()},
                               {"status", campaign::name_of(looks[i].status)}};
    if (!looks[i].changed.empty()) one["changed"] = looks[i].changed;
    if (const auto& state = looks[i].state) {
      one["exit_code"] = state->exit_code;
      one["message"] = state->message;
      one["tries"] = state->tries;
      one["seconds"] = state->seconds;
      one["host"] = state->host;
      one["time"] = state->time;
    }
    if (looks[i].status == TaskStatus::kDone && !state_is_empty(looks[i])) {
      for (const char* key :
           {"verdict", "reasons", "doubts", "colliding_points", "ignored", "floor", "warnings"}) {
        one[key] = looks[i].state->facts.value(key, nlohmann::ordered_json());
      }
      if (looks[i].state->facts.contains("ledger")) one["ledger"] = looks[i].state->facts["ledger"];
    }
    out["list"].push_back(std::move(one));
  }
  return out;
}

/// Verdicts with their caveats, each once with its tasks, in lines.
std::string caveats_text(const campaign::Plan& plan, const std::vector<TaskLook>& looks) {
  std::map<std::string, campaign::TaskList> tasks_of;
  for (std::size_t i = 0; i < looks.size(); ++i) {
    if (looks[i].status != TaskStatus::kDone || state_is_empty(looks[i])) continue;
    const nlohmann::ordered_json& facts = looks[i].state->facts;
    const std::string caveats = campaign::caveats_of(facts, plan.tasks[i].unit);
    if (caveats.empty()) continue;
    const std::string word = campaign::words_of(campaign::outcome_of(looks[i])).word;
    tasks_of[word + "; " + caveats].push_back(i);
  }
  std::string text;
  for (const auto& [words, tasks] : tasks_of) {
    text += tasks.size() == 1 ? fmt::format("task {}, {}", tasks[0], plan.tasks[tasks[0]].name())
                              : "tasks " + campaign::task_list_text(tasks);
    text += ": " + words + "\n";
  }
  return text;
}

std::string status_text(const campaign::Plan& plan, const std::vector<TaskLook>& looks) {
  std::string text = fmt::format("{}: {} {}\n", plan.name, format_count(plan.tasks.size()),
                                 plan.tasks.size() == 1 ? "task" : "tasks");
  for (const TaskStatus status : campaign::kStatuses) {
    const std::size_t count = count_of(looks, status);
    if (count == 0 && (status == TaskStatus::kBegun || status == TaskStatus::kOutdated)) continue;
    text += fmt::format("  {:<12}{:>7}\n", campaign::name_of(status), format_count(count));
  }
  text += campaign::OutcomeCounts(campaign::run_looks(plan, looks).looks).text() + "\n";
  const std::string ledgers =
      campaign::ledger_words(campaign::ledgers_of(campaign::run_looks(plan, looks).looks));
  if (!ledgers.empty()) text += "ledgers: " + ledgers + "\n";
  text += caveats_text(plan, looks);
  for (std::size_t i = 0; i < looks.size(); ++i) {
    if (looks[i].status == TaskStatus::kOutdated) {
      text += fmt::format("task {}, {}: {}, so its verdict is of an earlier file; run it again\n",
                          i, plan.tasks[i].name(), looks[i].changed);
    }
    if (looks[i].status != TaskStatus::kFailed) continue;
    text += fmt::format("task {}, {}: exit code {}: {}\n", i, plan.tasks[i].name(),
                        looks[i].state->exit_code, looks[i].state->message);
  }
  return text;
}

void run_status(const CampaignStatusOptions& options) {
  const campaign::Plan plan = campaign::read_plan(options.folder);
  std::vector<TaskLook> looks;
  for (const campaign::Task& task : plan.tasks) {
    looks.push_back(campaign::look_at(task, options.folder));
  }
  if (options.missing || options.failed) {
    const campaign::TaskList tasks = tasks_to_do(looks, options.failed);
    return print(tasks.empty() ? "" : campaign::task_list_text(tasks) + "\n");
  }
  print(options.json ? indented_text(status_json(plan, looks)) : status_text(plan, looks));
}

}  // namespace

void add_campaign_status(CLI::App& campaign) {
  const auto options = std::make_shared<CampaignStatusOptions>();
  CLI::App* command = campaign.add_subcommand(
      "status",
      "Say which tasks are done, running, interrupted, outdated, failed or missing, and what the "
      "runs found");
  command->add_option("DIR", options->folder, "Folder of the campaign")
      ->type_name("DIR")
      ->required();
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

}  // namespace clearway::tool
