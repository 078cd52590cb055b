#pragma once

namespace CLI {
class App;
}

namespace clearway::tool {

/// Adds the subcommand `clearway campaign plan`; campaign.cpp has the others.
void add_campaign_plan(CLI::App& campaign);

}  // namespace clearway::tool
