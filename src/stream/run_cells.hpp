#pragma once

#include <vector>

#include "core/cell_engine.hpp"
#include "core/hit_set.hpp"
#include "core/packed_cloud.hpp"
#include "core/progress.hpp"

namespace clearway {

/// Hands the planned cells to the engine, `threads` (0: all) at a time and in their order, and
/// collects the answers. Progress counts points. Throws what the engine throws.
HitSet run_cells(const PackedCloud& cloud, const std::vector<PlannedCell>& cells,
                 CellEngine& engine, bool first_pose, int threads, Progress& progress);

}  // namespace clearway
