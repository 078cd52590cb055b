#pragma once

#include "core/geometry/predicate.hpp"
#include "core/geometry/sweep_bounds.hpp"
#include "core/grid/float_predicate.hpp"
#include "core/grid/grid_build.hpp"
#include "core/grid/grid_task.hpp"
#include "core/query/search_result.hpp"
#include "core/util/device_bits.hpp"

/// The functions of the search. Every bound: docs/design/numerics.md, "Grid". Source: Schauer et
/// al. (the paper), section 3.2.
namespace clearway {

/// A sphere at a pose: its centre, and the distance up to which an environment point may touch the
/// sphere's points.
struct MovedSphere {
  Vec3 centre;
  double reach;
};

CLEARWAY_HD inline MovedSphere moved(const GridSceneView& scene, const GridSphere& sphere,
                                     std::uint32_t pose, double spread) {
  const double sum = scene.search_radius + scene.bounds[pose].stretch * sphere.radius + spread;
  return {transform(scene.poses[pose], sphere.centre), sum * (1 + 32 * kUnitRoundoff) + 1e-150};
}

/// False only if no point of the box can be touched. An overflow dismisses nothing.
CLEARWAY_HD inline bool may_touch(const Box& box, const MovedSphere& sphere) {
  const double squared = sphere.reach * sphere.reach * (1 + 8 * kUnitRoundoff);
  return !(least_squared_distance(box, sphere.centre) > squared);
}

/// Whether the part may touch the task's cell at a pose of its node.
CLEARWAY_HD inline bool part_is_open(const GridSceneView& scene, const GridPageView& page,
                                     const GridTask& task, std::uint32_t part) {
  const GridNode& node = scene.nodes[task.node];
  return may_touch(page.cells[task.cell].box,
                   moved(scene, scene.parts[part], node.mid, node.spread));
}

/// Whether the group may touch the cell at the pose: tested by box, then by one bit of the
/// occupancy.
CLEARWAY_HD inline bool group_is_open(const GridSceneView& scene, const GridPageView& page,
                                      std::uint32_t cell, std::uint32_t group, std::uint32_t pose) {
  const GridCell& grid = page.cells[cell];
  const MovedSphere sphere = moved(scene, scene.groups[group], pose, scene.bounds[pose].spread);
  if (!may_touch(grid.box, sphere)) return false;
  if (grid.exact_only || !(sphere.reach <= grid.group_radius)) return true;
  const GridPoint c = rebased(grid, sphere.centre, 0);
  const float reach = grid.group_reach;
  const bool within = c.x >= -reach && c.x <= grid.extent[0] + reach && c.y >= -reach &&
                      c.y <= grid.extent[1] + reach && c.z >= -reach &&
                      c.z <= grid.extent[2] + reach;
  if (!within) return true;
  return is_marked(page.group_occupancy + std::uint64_t{cell} * scene.word_count, scene.word_count,
                   grid.per_group_bit, c.x, c.y, c.z);
}

/// Whether point `index` has not been hit yet.
CLEARWAY_HD inline bool is_wanted(const GridSceneView& scene, const GridPageView& page,
                                  std::uint32_t cell, std::uint32_t index) {
  const std::uint64_t slot = std::uint64_t{cell} * scene.slots + index;
  return (page.hits[slot / kBlockPoints] >> (slot % kBlockPoints) & 1) == 0;
}

CLEARWAY_HD inline void mark_hit(const GridSceneView& scene, const GridPageView& page,
                                 std::uint32_t cell, std::uint32_t index) {
  const std::uint64_t slot = std::uint64_t{cell} * scene.slots + index;
  or_bits(page.hits[slot / kBlockPoints], std::uint64_t{1} << (slot % kBlockPoints));
}

/// The decision about a pair: by the predicate, or by floats alone. m: the moved model point.
CLEARWAY_HD inline bool is_hit(const GridSceneView& scene, const GridPageView& page,
                               std::uint32_t cell, std::uint32_t index, std::uint32_t pose,
                               std::uint32_t model_point, const Vec3& m) {
  const Vec3 e = position_of(scene, page, cell, index);
  if (!scene.float_alone) return collides(e, m, scene.radius);
  return collides_in_float(e, scene.poses[pose], scene.points[model_point], scene.radius);
}

/// A model point at a pose, for the predicate and in the cell's floats.
struct MovedPoint {
  std::uint32_t pose;
  std::uint32_t model_point;
  Vec3 m;
  GridPoint x;
};

/// Tests place `at` of the page's points against a moved model point, in float first.
CLEARWAY_HD inline void test_pair(const GridSceneView& scene, const GridPageView& page,
                                  std::uint32_t cell, std::uint32_t at, const MovedPoint& moved,
                                  GridStatistics& statistics) {
  const GridCell& grid = page.cells[cell];
  const GridPoint p = page.points[at];
  ++statistics.point_tests;
  const float dx = p.x - moved.x.x, dy = p.y - moved.x.y, dz = p.z - moved.x.z;
  const float squared = dx * dx + dy * dy + dz * dz;
  if (squared > grid.outer_squared) return;
  if (!is_wanted(scene, page, cell, p.index)) return;
  if (!(squared < grid.inner_squared)) {
    ++statistics.exact_tests;
    if (!is_hit(scene, page, cell, p.index, moved.pose, moved.model_point, moved.m)) return;
  }
  mark_hit(scene, page, cell, p.index);
  or_bits(page.done[at / 64], std::uint64_t{1} << (at % 64));
}

/// Tests the points of a range that are not hit yet.
CLEARWAY_HD inline void test_open(const GridSceneView& scene, const GridPageView& page,
                                  std::uint32_t cell, const BucketRange& range,
                                  const MovedPoint& moved, GridStatistics& statistics) {
  for (std::uint32_t first = range.begin; first < range.end;) {
    const std::uint32_t next = (first / 64 + 1) * 64;
    std::uint64_t open = ~page.done[first / 64] >> (first % 64);
    if (range.end < next) open &= (std::uint64_t{1} << (range.end - first)) - 1;
    for (; open != 0; open &= open - 1) {
      test_pair(scene, page, cell, first + lowest_bit(open), moved, statistics);
    }
    first = next;
  }
}

/// Tests the points of all grid cells within reach of the moved model point.
CLEARWAY_HD inline void search_buckets(const GridSceneView& scene, const GridPageView& page,
                                       std::uint32_t cell, const MovedPoint& moved,
                                       GridStatistics& statistics) {
  const GridCell& grid = page.cells[cell];
  const float at[3] = {moved.x.x, moved.x.y, moved.x.z};
  int lo[3], hi[3];
  for (int k = 0; k < 3; ++k) {
    const int last = grid_step(grid.extent[k], grid.per_bucket);
    lo[k] = grid_step(at[k] - grid.reach, grid.per_bucket);
    hi[k] = grid_step(at[k] + grid.reach, grid.per_bucket);
    if (lo[k] < 0) lo[k] = 0;
    if (hi[k] > last) hi[k] = last;
  }
  const std::uint64_t first = std::uint64_t{cell} * scene.bucket_count;
  for (int z = lo[2]; z <= hi[2]; ++z) {
    for (int y = lo[1]; y <= hi[1]; ++y) {
      for (int x = lo[0]; x <= hi[0]; ++x) {
        const std::uint64_t bucket = first + bucket_of(x, y, z, scene.bucket_count);
        const BucketRange range = page.buckets[bucket];
        ++statistics.bucket_tests;
        if (range.begin == range.end) continue;
        test_open(scene, page, cell, range, moved, statistics);
      }
    }
  }
}

/// Searches the cell around one model point at one pose.
CLEARWAY_HD inline void search_point(const GridSceneView& scene, const GridPageView& page,
                                     std::uint32_t cell, std::uint32_t pose,
                                     std::uint32_t model_point, GridStatistics& statistics) {
  const GridCell& grid = page.cells[cell];
  const Vec3 m = transform(scene.poses[pose], scene.points[model_point]);
  ++statistics.points_moved;
  if (grid.exact_only) {
    for (std::uint32_t i = 0; i < grid.count; ++i) {
      if (!page.page.is_searched(cell, i) || !is_wanted(scene, page, cell, i)) continue;
      ++statistics.exact_tests;
      if (is_hit(scene, page, cell, i, pose, model_point, m)) mark_hit(scene, page, cell, i);
    }
    return;
  }
  const GridPoint x = rebased(grid, m, 0);
  const float reach = grid.reach;
  const bool within = x.x >= -reach && x.x <= grid.extent[0] + reach && x.y >= -reach &&
                      x.y <= grid.extent[1] + reach && x.z >= -reach &&
                      x.z <= grid.extent[2] + reach;
  if (!within || !is_marked(page.occupancy + std::uint64_t{cell} * scene.word_count,
                            scene.word_count, grid.per_bit, x.x, x.y, x.z)) {
    return;
  }
  ++statistics.searches;
  search_buckets(scene, page, cell, {pose, model_point, m, x}, statistics);
}

/// An open pair of group and pose, encoded in one word.
CLEARWAY_HD inline std::uint32_t encode_pair(std::uint32_t group, std::uint32_t pose_of_run) {
  return group * kRunPoses + pose_of_run;
}

/// Searches lane `lane` of a pair's group: one model point, if the group has that many.
CLEARWAY_HD inline void search_lane(const GridSceneView& scene, const GridPageView& page,
                                    const GridTask& task, std::uint32_t pair, std::uint32_t lane,
                                    GridStatistics& statistics) {
  const std::uint32_t point = pair / kRunPoses * kGroupPoints + lane;
  const std::uint32_t pose = scene.nodes[task.node].first + pair % kRunPoses;
  if (point < scene.point_count) {
    search_point(scene, page, task.cell, pose, point, statistics);
  }
}

/// Encodes pair `index` of the groups of an open part and the poses of the task's node. Returns
/// false if the pair is dismissed or the group does not exist.
CLEARWAY_HD inline bool open_pair(const GridSceneView& scene, const GridPageView& page,
                                  const GridTask& task, std::uint32_t part, std::uint32_t index,
                                  std::uint32_t& pair, GridStatistics& statistics) {
  const GridNode& node = scene.nodes[task.node];
  const std::uint32_t group = part * kPartGroups + index % kPartGroups;
  const std::uint32_t pose_of_run = index / kPartGroups;
  if (group >= scene.group_count) return false;
  ++statistics.sphere_tests;
  pair = encode_pair(group, pose_of_run);
  return group_is_open(scene, page, task.cell, group, node.first + pose_of_run);
}

}  // namespace clearway
