#pragma once

#include <functional>

#include "clearway/query.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "core/grid/grid_scene.hpp"
#include "support/engines/answer_sets.hpp"

namespace clearway {

class PageEngine;

struct GridRun {
  GridOptions options = {};
  std::uint32_t slots = 2;
  std::uint32_t cells_a_page = 3;
  std::uint32_t work_list = 1024;
  int threads = 3;
};

/// Runs the engine `kdtree` over a whole cloud, as run_grid() runs its engine.
HitSet run_kdtree(const PackedCloud& cloud, const Query& query, const GridRun& run);

/// Runs the engine `grid` on the CPU over a whole cloud. Every cell is searched, with nodes of the
/// motion tree that together hold every pose: whole ranges for one cell, finer ones for the next.
/// statistics: the run's are added to them.
HitSet run_grid(const PackedCloud& cloud, const Query& query, const GridRun& run,
                GridStatistics* statistics = nullptr);

/// Makes an engine for the scene and returns what run_in finds with it, from cells staged in pages
/// of page_bytes.
using RunPages = std::function<HitSet(const GridScene& scene, std::uint64_t page_bytes,
                                      const std::function<HitSet(PageEngine& engine)>& run_in)>;

/// Searches a whole cloud as the other run_grid does, with the engine that run_pages makes.
HitSet run_grid(const PackedCloud& cloud, const Query& query, const GridRun& run,
                const RunPages& run_pages);

}  // namespace clearway
