#pragma once

#include <string>
#include <vector>

#include "campaign/plan.hpp"
#include "campaign/task_state.hpp"

namespace clearway::campaign {

/// The tasks of a plan that are runs, not shards, and how they look: a run one of whose shards
/// failed has failed.
struct RunLooks {
  Plan plan;
  std::vector<TaskLook> looks;
};
RunLooks run_looks(const Plan& plan, const std::vector<TaskLook>& looks);

/// Everything that the page says, as one JSON object. Of run_looks(), as page_text().
nlohmann::ordered_json page_facts(const Plan& plan, const std::vector<TaskLook>& looks,
                                  const std::string& date);

/// One HTML file without scripts: for each radius a table of vehicles and routes. What is not done
/// is shown as such, never as clear.
std::string page_text(const Plan& plan, const std::vector<TaskLook>& looks,
                      const std::string& date);

}  // namespace clearway::campaign
