#pragma once

#include "core/geometry/predicate.hpp"
#include "core/grid/grid_index.hpp"

/// The functions that put the points of a page into its grid.
namespace clearway {

/// The stored position of point `index` of a cell, as the predicate takes it.
CLEARWAY_HD inline Vec3 position_of(const GridSceneView& scene, const GridPageView& page,
                                    std::uint32_t cell, std::uint32_t index) {
  return page.page.position(scene.quantisation, page.page.cell(cell), index);
}

/// A position rebased to the cell's origin and rounded to float.
CLEARWAY_HD inline GridPoint rebased(const GridCell& cell, const Vec3& e, std::uint32_t index) {
  return {static_cast<float>(e.x - cell.origin.x), static_cast<float>(e.y - cell.origin.y),
          static_cast<float>(e.z - cell.origin.z), index};
}

/// The key by which a slot of the page is sorted: the bucket, counted over all cells; past the last
/// bucket if the slot holds no point.
CLEARWAY_HD inline std::uint32_t sort_key(const GridSceneView& scene, const GridPageView& page,
                                          std::uint32_t slot) {
  const std::uint32_t cell = slot / scene.slots, index = slot % scene.slots;
  const GridCell& grid = page.cells[cell];
  if (!page.page.is_searched(cell, index)) return page.page.shape.cells * scene.bucket_count;
  const std::uint32_t first = cell * scene.bucket_count;
  if (grid.exact_only) return first;
  const GridPoint p = rebased(grid, position_of(scene, page, cell, index), index);
  return first + bucket_of(grid_step(p.x, grid.per_bucket), grid_step(p.y, grid.per_bucket),
                           grid_step(p.z, grid.per_bucket), scene.bucket_count);
}

/// Puts the point of the slot that is sorted to place `at` of `count` there, and records it in its
/// bucket and in the occupancies. keys, order: the sorted keys and their slots.
CLEARWAY_HD inline void place_point(const GridSceneView& scene, const GridPageView& page,
                                    const std::uint32_t* keys, const std::uint32_t* order,
                                    std::uint32_t at, std::uint32_t count) {
  const std::uint32_t key = keys[at];
  const std::uint32_t cell = order[at] / scene.slots, index = order[at] % scene.slots;
  const GridCell& grid = page.cells[cell];
  if (grid.exact_only || !page.page.is_searched(cell, index)) return;
  const GridPoint p = rebased(grid, position_of(scene, page, cell, index), index);
  page.points[at] = p;
  if (at == 0 || keys[at - 1] != key) page.buckets[key].begin = at;
  if (at + 1 == count || keys[at + 1] != key) page.buckets[key].end = at + 1;
  const std::uint64_t first = std::uint64_t{cell} * scene.word_count;
  mark_around(page.occupancy + first, scene.word_count, grid.per_bit, grid.reach, p);
  mark_around(page.group_occupancy + first, scene.word_count, grid.per_group_bit, grid.group_reach,
              p);
}

}  // namespace clearway
