#include <fmt/chrono.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <filesystem>
#include <memory>
#include <span>

#include "campaign/page/campaign_page.hpp"
#include "campaign/plan.hpp"
#include "campaign/task_state.hpp"
#include "clearway/error.hpp"
#include "cli/campaign/commands.hpp"
#include "cli/support/console.hpp"
#include "cli/support/program_json.hpp"
#include "io/files/json.hpp"
#include "io/files/pending_file.hpp"

namespace clearway::tool {
namespace {

constexpr const char* kPageName = "index.html";

struct CampaignReportOptions {
  std::filesystem::path folder;
  std::string date;
  bool json = false, force = false;
};

std::string date_of_page() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  return fmt::format("{:%Y-%m-%d %H:%M} UTC", fmt::gmtime(now));
}

void write_campaign_page(CampaignReportOptions& options) {
  const campaign::Plan plan = campaign::read_plan(options.folder);
  PendingFile pending(options.folder / kPageName, options.force);
  if (options.date.empty()) options.date = date_of_page();
  std::vector<campaign::TaskLook> looks;
  for (const campaign::Task& task : plan.tasks) {
    if (stop_requested()) throw Interrupted("");
    looks.push_back(campaign::look_at(task, options.folder));
  }
  const campaign::RunLooks runs = campaign::run_looks(plan, looks);
  const std::string page = campaign::page_text(runs.plan, runs.looks, options.date);
  File::create(pending.partial()).write(std::as_bytes(std::span(page)));
  pending.publish();
  const auto facts = campaign::page_facts(runs.plan, runs.looks, options.date);
  spdlog::info("{}: {}", (options.folder / kPageName).string(),
               campaign::OutcomeCounts(runs.looks).text());
  if (options.json) print(indented_text(facts));
}

}  // namespace

void add_campaign_report(CLI::App& campaign) {
  const auto options = std::make_shared<CampaignReportOptions>();
  CLI::App* command = campaign.add_subcommand(
      "report", "Write a page with the verdicts of all tasks: index.html in the folder");
  command->add_option("DIR", options->folder, "Folder of the campaign")
      ->type_name("DIR")
      ->required();
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

}  // namespace clearway::tool
