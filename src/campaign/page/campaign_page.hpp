#pragma once

#include <string>
#include <vector>

#include "campaign/task_state.hpp"

namespace clearway::campaign {

/// Everything that the page says, as one JSON object. plan, looks: those of run_looks().
nlohmann::ordered_json page_facts(const Plan& plan, const std::vector<TaskLook>& looks,
                                  const std::string& date);

/// One HTML file without scripts, with a table of vehicles and routes for each radius. Runs that
/// are not done are shown as such, never as clear. plan, looks: those of run_looks().
std::string page_text(const Plan& plan, const std::vector<TaskLook>& looks,
                      const std::string& date);

}  // namespace clearway::campaign
