#pragma once

#include <string>
#include <vector>

#include "campaign/outcome.hpp"

namespace clearway::campaign {

/// Everything that the page says, as one JSON object. Takes what run_looks() gives, as
/// page_text() does.
nlohmann::ordered_json page_facts(const Plan& plan, const std::vector<TaskLook>& looks,
                                  const std::string& date);

/// One HTML file without scripts: for each radius a table of vehicles and routes. What is not done
/// is shown as such, never as clear.
std::string page_text(const Plan& plan, const std::vector<TaskLook>& looks,
                      const std::string& date);

}  // namespace clearway::campaign
