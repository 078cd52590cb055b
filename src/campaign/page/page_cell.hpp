#pragma once

#include <string>

#include "campaign/plan.hpp"
#include "campaign/task_state.hpp"

namespace clearway::campaign {

/// What a cell of the page says of its task.
enum class CellKind {
  kConflict,
  kDoubtful,
  kClear,
  kFailed,
  kUnfinished
};  ///< kDoubtful: clear, but warned of
inline constexpr CellKind kCellKinds[]{CellKind::kConflict, CellKind::kDoubtful, CellKind::kClear,
                                       CellKind::kFailed, CellKind::kUnfinished};

struct CellLook {
  const char* name;   ///< in facts and as a class of styles
  const char* sign;   ///< tells it without colour
  const char* words;  ///< for the legend
};
const CellLook& look_of(CellKind kind);

CellKind kind_of(const TaskLook& look);

/// "conflict", "clear", "failed (3)", "missing".
std::string cell_word(const TaskLook& look);

/// "0.032 m"; where it is not known, what is: "< 0.1 m". Empty of a task that is not done.
std::string cell_distance(const Task& task, const TaskLook& look);

/// More of it, for a line of text.
std::string cell_details(const Task& task, const TaskLook& look);

/// Below the campaign's folder: the report where there is one, else the log; or "".
std::string cell_link(const Task& task, const TaskLook& look);

}  // namespace clearway::campaign
