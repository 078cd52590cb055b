#pragma once

#include "core/hit_set.hpp"
#include "core/packed_cloud.hpp"
#include "core/question.hpp"
#include "grid/grid_scene.hpp"

namespace clearway {

struct GridRun {
  GridOptions options;
  std::uint32_t slots = 2;
  std::size_t cells_a_page = 3;
  std::uint32_t work_list = 1024;
};

/// The engine `grid` on the CPU over a whole cloud. Every cell is searched, with nodes of the
/// motion tree that together hold every pose: whole ranges for one cell, finer ones for the next.
HitSet run_grid(const PackedCloud& cloud, const Question& question, const GridRun& run);

}  // namespace clearway
