#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace clearway::campaign {

/// Numbers of tasks, ascending.
using TaskList = std::vector<std::size_t>;

/// "3,7-9", as sbatch --array takes it.
std::string task_list_text(const TaskList& tasks);

/// The numbers of such a text, each once; none where it is no such text.
std::optional<TaskList> parse_task_list(const std::string& text);

}  // namespace clearway::campaign
