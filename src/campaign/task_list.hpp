#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace clearway::campaign {

/// Numbers of tasks, ascending.
using TaskList = std::vector<std::size_t>;

/// The numbers as sbatch --array takes them, for example "3,7-9".
std::string task_list_text(const TaskList& tasks);

/// The numbers in such a text, each once; nothing where it is no such text.
std::optional<TaskList> parse_task_list(const std::string& text);

}  // namespace clearway::campaign
