#include "core/grid/grid_cell.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/grid/grid_task.hpp"

namespace clearway {
namespace {

constexpr double kFloatRoundoff = 0x1p-24;

/// Greatest length that floats handle, because the squares of longer ones would not fit a float;
/// those are left to the predicate alone.
constexpr double kLargest = 1e15;

/// Least length that floats distinguish, because the squares of shorter ones would not fit a float.
constexpr double kLeast = 1e-12;

/// Bound on the reach in grid cells, which limits how many of them a search looks up on an axis.
constexpr double kStepsPerReach = 4;

/// Greatest number of grid cells along an extent, so that a grid cell's number is an int.
constexpr double kMostSteps = 1 << 20;

float rounded_up(double x) { return std::nextafter(static_cast<float>(x), INFINITY); }
float rounded_down(double x) { return std::nextafter(static_cast<float>(x), -INFINITY); }

/// The finest of a few resolutions at which the grid cells marked within `reach` of the points are
/// likely to be less than half of an occupancy's bits.
double occupancy_step(const GridCell& grid, double reach, double extent, double bits) {
  double step = reach / 2;
  for (int doubling = 0; doubling < 3; ++doubling, step *= 2) {
    double all = 1;
    for (const float side : grid.extent) all *= (static_cast<double>(side) + 2 * reach) / step + 1;
    const double around_points = grid.count * std::pow(2 * reach / step + 1, 3);
    if (std::min(all, around_points) <= bits / 2) break;
  }
  return std::max(step, (extent + 2 * reach) / kMostSteps);
}

}  // namespace

GridCell make_grid_cell(const GridScene& scene, const QuantumBox& box, std::uint32_t count) {
  const GridSceneView& view = scene.view();
  GridCell grid{};
  grid.box = position_box(view.quantisation, box);
  grid.origin = grid.box.lo;
  grid.count = count;
  double extent = 0;
  for (int k = 0; k < 3; ++k) {
    const double side = grid.box.hi[k] - grid.box.lo[k];
    extent = std::max(extent, side);
    // Computed as the point at the upper side is rebased
    grid.extent[k] = static_cast<float>(side);
  }
  const double radius = view.search_radius;
  // Bound on how far rebasing to floats moves two points relative to each other.
  const double shift = 4 * kFloatRoundoff * (extent + 2 * radius);
  const double outer = (radius + std::sqrt(3.0) * shift) * (1 + 8 * kFloatRoundoff) + kLeast;
  const double inner = (radius - std::sqrt(3.0) * shift) * (1 - 8 * kFloatRoundoff);
  const double group_radius = std::max(scene.group_radius(), outer);
  const double group_reach =
      group_radius + 4 * kFloatRoundoff * (extent + 2 * group_radius) + kLeast;
  grid.exact_only = !(extent < kLargest && outer < kLargest);
  if (grid.exact_only) return grid;
  grid.reach = rounded_up(outer);
  grid.outer_squared = rounded_up(outer * outer * (1 + 4 * kFloatRoundoff));
  const bool can_accept = !view.float_alone && inner > kLeast;
  grid.inner_squared = can_accept ? rounded_down(inner * inner * (1 - 4 * kFloatRoundoff)) : 0.0F;
  const double bits = 64.0 * view.word_count;
  const double step =
      std::max({scene.grid_cell(), outer / kStepsPerReach, (extent + 2 * outer) / kMostSteps});
  grid.per_bucket = static_cast<float>(1 / std::min(step, kLargest));
  grid.per_bit = static_cast<float>(1 / occupancy_step(grid, outer, extent, bits));
  if (group_reach < kLargest) {
    grid.group_radius = group_radius;
    grid.group_reach = rounded_up(group_reach);
    grid.per_group_bit = static_cast<float>(1 / occupancy_step(grid, group_reach, extent, bits));
  }
  return grid;
}

std::uint64_t plan_page(const GridScene& scene, const PageRef& page, std::span<GridCell> cells,
                        std::span<std::uint64_t> cell_runs, std::span<std::uint32_t> entry_runs) {
  assert(cells.size() >= page.shape.cells && cell_runs.size() > page.shape.cells);
  assert(entry_runs.size() >= page.shape.nodes);
  const std::span<const GridNode> nodes = scene.nodes();
  std::uint32_t entry = 0;
  cell_runs[0] = 0;
  for (std::uint32_t c = 0; c < page.shape.cells; ++c) {
    const PageCell& stored = page.cell(c);
    cells[c] = make_grid_cell(scene, stored.box, stored.count);
    cells[c].first_entry = entry;
    cells[c].node_count = stored.node_count;
    std::uint32_t runs = 0;
    for (std::uint32_t i = 0; i < stored.node_count; ++i) {
      entry_runs[entry++] = runs;
      runs += nodes[page.nodes(stored)[i]].runs;
    }
    cell_runs[c + 1] = cell_runs[c] + runs;
  }
  return cell_runs[page.shape.cells] * task_slices(scene.view());
}

}  // namespace clearway
