#pragma once

#include <filesystem>
#include <string>

#include "campaign/plan.hpp"
#include "campaign/task_list.hpp"

namespace clearway::campaign {

inline constexpr const char* kPlanName = "plan.json";

/// One JSON object with a line a task, so that a task is read without reading all of them.
std::string plan_text(const Plan& plan);

/// Of a campaign's folder, all tasks; tasks: those alone, in their order. Throws UsageError where
/// there is no plan or no task of a number; InputError where the plan is damaged.
Plan read_plan(const std::filesystem::path& folder);
Plan read_plan(const std::filesystem::path& folder, const TaskList& tasks);

}  // namespace clearway::campaign
