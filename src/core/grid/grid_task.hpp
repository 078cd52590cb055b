#pragma once

#include <cstdint>

#include "core/cloud/packed_cloud.hpp"
#include "core/grid/grid_view.hpp"
#include "core/util/macros.hpp"

/// How a page's search is divided into tasks.
namespace clearway {

/// One task: one cell, at most kRunPoses poses and kTaskParts parts of the model.
struct GridTask {
  std::uint32_t cell;
  std::uint32_t node;
  std::uint32_t first_part;
};

CLEARWAY_HD inline std::uint32_t task_slices(const GridSceneView& scene) {
  return static_cast<std::uint32_t>(divide_up(scene.part_count, kTaskParts));
}

/// The last i below n with starts[i] <= value; starts ascend from 0.
template <typename Value>
CLEARWAY_HD inline std::uint32_t last_not_above(const Value* starts, std::uint32_t n, Value value) {
  std::uint32_t lo = 0;
  for (std::uint32_t hi = n; hi - lo > 1;) {
    const std::uint32_t middle = lo + (hi - lo) / 2;
    (starts[middle] <= value ? lo : hi) = middle;
  }
  return lo;
}

/// The task with this index, which is below cell_runs[cells] * task_slices().
CLEARWAY_HD inline GridTask task_of(const GridSceneView& scene, const GridPageView& page,
                                    std::uint64_t index) {
  const std::uint32_t slices = task_slices(scene);
  const std::uint64_t run = index / slices;
  const std::uint32_t cell = last_not_above(page.cell_runs, page.page.shape.cells, run);
  const GridCell& grid = page.cells[cell];
  const auto in_cell = static_cast<std::uint32_t>(run - page.cell_runs[cell]);
  const std::uint32_t* starts = page.entry_runs + grid.first_entry;
  const std::uint32_t entry = last_not_above(starts, grid.node_count, in_cell);
  std::uint32_t node = page.page.nodes(page.page.cell(cell))[entry];
  const GridNode& planned = scene.nodes[node];
  if (planned.count > kRunPoses) node = scene.runs[planned.first_run + (in_cell - starts[entry])];
  return {cell, node, static_cast<std::uint32_t>(index % slices) * kTaskParts};
}

}  // namespace clearway
