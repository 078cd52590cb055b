#include "campaign/plan.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <vector>

#include "campaign/slurm_script.hpp"
#include "clearway/search.hpp"
#include "cli/campaign/commands.hpp"
#include "cli/campaign/question_reader.hpp"
#include "cli/support/console.hpp"
#include "cli/support/options.hpp"
#include "core/util/format.hpp"
#include "findings/ledger/ledger_places.hpp"
#include "findings/ledger/ledger_table.hpp"
#include "io/files/file.hpp"
#include "io/files/input_error.hpp"

namespace clearway::tool {
namespace {

namespace fs = std::filesystem;

struct CampaignPlanOptions {
  fs::path file, folder;
  bool force = false;
};

campaign::SlurmJob slurm_job(const campaign::Campaign& asked, const fs::path& folder) {
  campaign::SlurmJob job{.program = fs::read_symlink("/proc/self/exe"),
                         .folder = fs::absolute(folder).lexically_normal(),
                         .memory_bytes = SearchOptions{}.memory_bytes,
                         .threads = {},
                         .options = asked.slurm};
  for (const campaign::Argument& limit : asked.limits) {
    if (limit.option == "--memory") job.memory_bytes = parse_size(limit.option, limit.value);
    if (limit.option == "--threads") job.threads = limit.value;
    if (limit.option == "--device") job.gpu = limit.value == "cuda";
  }
  return job;
}

void make_folder(const fs::path& folder) {
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed) throw system_failure(folder.string() + ": cannot create", failed.value());
}

void write_script(const fs::path& path, const std::string& text) {
  replace_file(path, text);
  fs::permissions(path, fs::perms::owner_exec, fs::perm_options::add);
}

/// Plans a run for each vehicle, route and radius, and shows its progress.
campaign::Plan plan_of(const campaign::Campaign& asked, const fs::path& file) {
  ConsoleProgress progress;
  const std::size_t tasks = asked.vehicles.size() * asked.routes.size() * asked.radii.size();
  progress.begin("Reading inputs", tasks, "runs");
  QuestionReader questions(file, asked.shard_seconds);
  campaign::Plan plan = campaign::make_plan(asked, [&](const campaign::PlannedRun& run) {
    if (progress.stop_requested()) throw Interrupted("");
    progress.advance(1);
    return questions.facts_of(run);
  });
  progress.end();
  return plan;
}

/// The tables of ledgers that tasks have and that do not exist yet. Throws InputError for those
/// that a task would refuse.
std::vector<fs::path> missing_ledgers(const campaign::Plan& plan) {
  std::vector<fs::path> missing;
  for (const campaign::Task& task : plan.tasks) {
    const fs::path table = task.ledger;
    std::error_code unknown;
    if (table.empty()) continue;
    if (fs::exists(table, unknown)) {
      LedgerTable(text_of_file(table), table.string());
    } else if (fs::exists(places_of(table), unknown)) {
      throw InputError(places_of(table).string() + ": is there, and its table " + table.string() +
                       " is missing; restore it, or remove the places to begin a new ledger");
    } else {
      missing.push_back(table);
    }
  }
  return missing;
}

/// Begins ledgers, so that pages can be made before the first update.
void begin_ledgers(const std::vector<fs::path>& tables) {
  for (const fs::path& table : tables) {
    make_folder(table.parent_path());
    replace_file(table, LedgerTable().text());
  }
  if (!tables.empty()) {
    spdlog::info("{} begun, such as {}", counted(tables.size(), "ledger is", "ledgers are"),
                 tables.front().string());
  }
}

void run_plan(const CampaignPlanOptions& options) {
  const campaign::Campaign asked = campaign::read_campaign(options.file);
  for (const Message& note : asked.notes) log_message(note);
  const campaign::Plan plan = plan_of(asked, options.file);
  const std::vector<fs::path> ledgers = missing_ledgers(plan);
  const std::string text = campaign::plan_text(plan);
  const fs::path planned = options.folder / campaign::kPlanName;
  std::error_code unknown;
  const bool exists = fs::exists(planned, unknown);
  const bool same = exists && text_of_file(planned) == text;
  if (exists && !same && !options.force) {
    throw UsageError(planned.string() + ": is another plan; --force replaces it. Finished runs " +
                     "of the same questions stay");
  }
  // The scripts hold what the plan does not, such as the options of sbatch.
  make_folder(options.folder / "slurm");
  const campaign::SlurmJob job = slurm_job(asked, options.folder);
  write_script(options.folder / "campaign.sbatch", campaign::sbatch_text(job, plan));
  write_script(options.folder / "submit.sh", campaign::submit_text(job, plan));
  if (same) {
    spdlog::info("{}: is this plan already; only the scripts are written", planned.string());
  } else {
    replace_file(planned, text);
  }
  begin_ledgers(ledgers);
  print(fmt::format("{}: {} ({}, {}, {})\n", asked.name, counted(plan.tasks.size(), "task"),
                    counted(asked.vehicles.size(), "vehicle"),
                    counted(asked.routes.size(), "route"),
                    counted(asked.radii.size(), "radius", "radii")));
}

}  // namespace

void add_campaign_plan(CLI::App& campaign) {
  const auto options = std::make_shared<CampaignPlanOptions>();
  CLI::App* command = campaign.add_subcommand(
      "plan", "Make a plan of tasks in a folder, and the scripts that submit it to Slurm");
  command->add_option("CAMPAIGN", options->file, "What is asked, a JSON file")
      ->type_name("FILE")
      ->required();
  command->add_option("-o,--output", options->folder, "Folder of the campaign, made if missing")
      ->type_name("DIR")
      ->required();
  command->add_flag("--force", options->force,
                    "Replace another plan; finished runs of the same questions stay");
  command->footer(
      "Reads every store's index, model and trajectory once, and refuses what a task would "
      "refuse.\n"
      "An error names the key of the JSON file. The same inputs give the same plan.\n"
      "Example: clearway campaign plan campaign.json -o spring");
  command->callback(
      [options] { run_stoppable(options->folder, kStartsAgain, [&] { run_plan(*options); }); });
}

}  // namespace clearway::tool
