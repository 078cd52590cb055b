#include <CLI/CLI.hpp>

#include "cli/campaign/commands.hpp"
#include "cli/commands.hpp"

namespace clearway::tool {

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
