#pragma once

#include <string>

#include "campaign/outcome.hpp"

namespace clearway::campaign {

/// The word in a cell: "conflict", "undecided", "clear", "clear?" where there were warnings,
/// "failed (3)", or the name of the task's status, such as "missing".
std::string cell_word(const TaskLook& look);

/// The least distance in a cell, for example "0.032 m"; where it is not known, a bound such as "<
/// 0.1 m". Empty where nothing is known, because the task is not done or its search could not have
/// found anything.
std::string cell_distance(const Task& task, const TaskLook& look);

/// The details of a cell, as a line of text.
std::string cell_details(const Task& task, const TaskLook& look);

/// The link of a cell, relative to the campaign's folder: for a failed task its log; for a finished
/// one its report or, where there is none, its run.json; otherwise empty.
std::string cell_link(const Task& task, const TaskLook& look);

}  // namespace clearway::campaign
