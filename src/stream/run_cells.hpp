#pragma once

#include <vector>

#include "core/answer.hpp"
#include "core/cell_engine.hpp"
#include "core/packed_cloud.hpp"
#include "core/progress.hpp"
#include "core/question.hpp"

namespace clearway {

/// Hands the planned cells to the engine, `threads` (0: all) at a time and in their order, and
/// collects the answers. Progress counts points. Throws what the engine throws.
Answer run_cells(const PackedCloud& cloud, const std::vector<PlannedCell>& cells,
                 CellEngine& engine, const Question& question, int threads, Progress& progress);

}  // namespace clearway
