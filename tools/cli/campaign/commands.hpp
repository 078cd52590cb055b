#pragma once

namespace CLI {
class App;
}

namespace clearway::tool {

/// The functions below add the subcommands of `clearway campaign`.
void add_campaign_plan(CLI::App& campaign);
void add_campaign_run(CLI::App& campaign, int& exit_code);
void add_campaign_status(CLI::App& campaign);
void add_campaign_report(CLI::App& campaign);

}  // namespace clearway::tool
