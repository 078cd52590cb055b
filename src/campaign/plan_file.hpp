#pragma once

#include <filesystem>
#include <string>

#include "campaign/plan.hpp"
#include "campaign/task_list.hpp"

namespace clearway::campaign {

inline constexpr const char* kPlanName = "plan.json";

/// The plan as one JSON object with one line for each task, so that a task can be read without
/// parsing all of them.
std::string plan_text(const Plan& plan);

/// Reads the plan of a campaign's folder: all of its tasks, or those with the numbers in `tasks`,
/// in their order. Throws UsageError where there is no plan or no task with a number, and
/// InputError where the plan is damaged.
Plan read_plan(const std::filesystem::path& folder);
Plan read_plan(const std::filesystem::path& folder, const TaskList& tasks);

}  // namespace clearway::campaign
