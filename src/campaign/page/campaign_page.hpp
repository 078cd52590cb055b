#pragma once

#include <string>
#include <vector>

#include "campaign/task_state.hpp"
#include "io/files/json.hpp"

namespace clearway::campaign {

/// Everything that the page says, as one JSON object. runs: those of runs_of().
Json page_facts(const Plan& plan, const std::vector<TaskStatus>& runs, const std::string& date);

/// One HTML file without scripts, with a table of vehicles and routes for each radius. Runs that
/// are not done are shown as such, never as clear. facts: those of page_facts().
std::string page_text(const Json& facts, const std::vector<TaskStatus>& runs);

}  // namespace clearway::campaign
