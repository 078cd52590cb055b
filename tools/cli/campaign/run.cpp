#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "campaign/plan.hpp"
#include "campaign/task_state.hpp"
#include "clearway/error.hpp"
#include "cli/campaign/commands.hpp"
#include "cli/campaign/task_queue.hpp"
#include "cli/support/program.hpp"

namespace clearway::tool {
namespace {

struct CampaignRunOptions {
  std::filesystem::path folder;
  std::optional<std::string> tasks;
  bool all = false, fail_on_collision = false;
  int jobs = 1;
};

campaign::Plan plan_to_run(const CampaignRunOptions& options) {
  if (options.all) return campaign::read_plan(options.folder);
  if (!options.tasks) throw UsageError("expected --task with numbers, or --all");
  if (options.tasks->empty()) {
    // What `campaign status --missing` prints where nothing is missing.
    spdlog::info("nothing to do, because the list of tasks is empty");
    return campaign::read_plan(options.folder, {});
  }
  const auto tasks = campaign::parse_task_list(*options.tasks);
  if (!tasks) {
    throw UsageError("--task: " + *options.tasks + ": expected numbers from 0, such as 3,7-9");
  }
  return campaign::read_plan(options.folder, *tasks);
}

/// The runs among these tasks, those that were done before included.
std::vector<campaign::TaskLook> runs_of(const campaign::Plan& plan,
                                        const std::filesystem::path& folder) {
  std::vector<campaign::TaskLook> looks;
  for (const campaign::Task& task : plan.tasks) looks.push_back(campaign::look_at(task, folder));
  return campaign::run_looks(plan, looks).looks;
}

int run_tasks(const CampaignRunOptions& options) {
  const campaign::Plan plan = plan_to_run(options);
  const auto folder = std::filesystem::absolute(options.folder).lexically_normal();
  TaskQueue queue(plan, folder, options.jobs, options.all);
  const int code = queue.run();
  const std::vector<campaign::TaskLook> runs = runs_of(plan, folder);
  const campaign::OutcomeCounts outcomes(runs);
  if (outcomes.all() > 0) spdlog::info("{}: {}", plan.name, outcomes.text());
  const std::string ledgers = campaign::ledger_words(campaign::ledgers_of(runs));
  if (!ledgers.empty()) spdlog::info("{}: ledgers: {}", plan.name, ledgers);
  if (code != kDone || !options.fail_on_collision) return code;
  const auto ends_as = [&](campaign::Outcome outcome) {
    return std::ranges::count(runs, outcome, campaign::outcome_outside) > 0;
  };
  if (ends_as(campaign::Outcome::kConflict)) return kDiffers;
  return ends_as(campaign::Outcome::kUndecided) ? int{kUndecided} : code;
}

}  // namespace

void add_campaign_run(CLI::App& campaign, int& exit_code) {
  const auto options = std::make_shared<CampaignRunOptions>();
  CLI::App* command =
      campaign.add_subcommand("run", "Do tasks of a campaign; finished ones return at once");
  command->add_option("DIR", options->folder, "Folder of the campaign")
      ->type_name("DIR")
      ->required();
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
      "resumes. The exit code is that of the task, or the largest one of several; the verdicts of\n"
      "runs count only with --fail-on-collision, and only where no task failed.\n"
      "With --all, interrupted tasks (5) are queued again, and those that failed for the "
      "machine's\n"
      "sake (4) at most twice.\n"
      "Example: clearway campaign run spring --all --jobs 2");
  command->callback([options, &exit_code] { exit_code = run_tasks(*options); });
}

}  // namespace clearway::tool
