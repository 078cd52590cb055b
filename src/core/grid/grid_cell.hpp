#pragma once

#include <cstdint>
#include <span>

#include "core/grid/grid_scene.hpp"

namespace clearway {

/// The grid and the filters of a cell. first_entry and node_count are left to the caller.
GridCell make_grid_cell(const GridScene& scene, const QuantumBox& box, std::uint32_t count);

/// Prepares the search of a page: its cells' grids and its tasks. cells: one for each cell;
/// cell_runs: one more than cells; entry_runs: one for each motion node of the page. Returns the
/// number of tasks.
std::uint64_t plan_page(const GridScene& scene, const PageRef& page, std::span<GridCell> cells,
                        std::span<std::uint64_t> cell_runs, std::span<std::uint32_t> entry_runs);

}  // namespace clearway
