#pragma once

#include <functional>
#include <memory>

#include "clearway/query.hpp"
#include "core/grid/grid_scene.hpp"
#include "cpu/grid_cpu_engine.hpp"
#include "support/engines/answer_sets.hpp"

namespace clearway {

struct GridRun {
  GridOptions options = {};
  std::uint32_t slots = 2;
  std::uint32_t cells_a_page = 3;
  std::uint32_t work_list = 1024;
  int threads = 3;
};

/// Runs the engine `kdtree` over a whole cloud, as run_grid() runs its engine.
SearchResult run_kdtree(const PackedCloud& cloud, const Query& query, const GridRun& run);

/// Runs the engine `grid` on the CPU over a whole cloud. Every cell is searched, with nodes of the
/// motion tree that together hold every pose: whole ranges for one cell, finer ones for the next.
/// statistics: the run's are added to them.
SearchResult run_grid(const PackedCloud& cloud, const Query& query, const GridRun& run,
                      GridStatistics* statistics = nullptr);

/// Runs an engine over pages.
using RunIn = std::function<SearchResult(PageEngine& engine)>;

/// Searches a whole cloud as the other run_grid does, with the engine that run_pages makes for the
/// scene and gives to run_in.
SearchResult run_grid(
    const PackedCloud& cloud, const Query& query, const GridRun& run,
    const std::function<SearchResult(const GridScene& scene, const SlotLayout& layout,
                                     const RunIn& run_in)>& run_pages);

}  // namespace clearway
