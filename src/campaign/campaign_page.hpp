#pragma once

#include <string>
#include <vector>

#include "campaign/plan.hpp"
#include "campaign/task_state.hpp"

namespace clearway::campaign {

/// Everything that the page says, as one JSON object.
nlohmann::ordered_json page_facts(const Plan& plan, const std::vector<TaskLook>& looks,
                                  const std::string& date);

/// One HTML file without scripts: for each radius a table of vehicles and routes. What is not done
/// is shown as such, never as clear. looks: one a task of the plan.
std::string page_text(const Plan& plan, const std::vector<TaskLook>& looks,
                      const std::string& date);

}  // namespace clearway::campaign
