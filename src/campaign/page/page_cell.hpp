#pragma once

#include <string>

#include "campaign/outcome.hpp"

namespace clearway::campaign {

/// "conflict", "clear", "clear?" where something was warned of, "failed (3)", "missing".
std::string cell_word(const TaskLook& look);

/// "0.032 m"; where it is not known, what is: "< 0.1 m". Empty where nothing is
/// known: the task is not done, or its search could not have found anything.
std::string cell_distance(const Task& task, const TaskLook& look);

/// More of it, for a line of text.
std::string cell_details(const Task& task, const TaskLook& look);

/// Below the campaign's folder: the report where there is one, else the log; or "".
std::string cell_link(const Task& task, const TaskLook& look);

}  // namespace clearway::campaign
