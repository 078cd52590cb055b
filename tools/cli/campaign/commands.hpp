#pragma once

#include <filesystem>

#include "campaign/plan.hpp"

namespace CLI {
class App;
}

namespace clearway::tool {

/// Adds the subcommand `clearway campaign plan`; campaign.cpp has the others.
void add_campaign_plan(CLI::App& campaign);

/// Works through the tasks of a plan, `jobs` at a time, each command in a process of its own. To be
/// called once, while this process has one thread. campaign: the absolute path of its folder.
/// tries_again: whether to do tasks again that were interrupted or that failed with kResource.
/// SIGINT and SIGTERM end the running commands. Returns the exit code: kInterrupted, or the most
/// urgent one of the tasks.
int do_tasks(const campaign::Plan& plan, const std::filesystem::path& campaign, int jobs,
             bool tries_again);

}  // namespace clearway::tool
