// Tests of what only the grid engine has: its options, its work list, its pages, its statistics.
#include <cmath>

#include "clearway/error.hpp"
#include "core/grid/grid_cell.hpp"
#include "core/grid/grid_search.hpp"
#include "core/grid/grid_size.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/engines/brute_force.hpp"
#include "support/engines/grid_runs.hpp"
#include "support/memory_cloud.hpp"
#include "support/scenes.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

const Quantisation kMillimetre{{1e-3, 1e-3, 1e-3}, {500, -200, 0}};

struct SceneOfGrid {
  Random random{9};
  std::vector<Quantum> points;
  std::vector<Vec3> model = random_points(random, {{-0.5, -0.4, -0.3}, {0.5, 0.4, 0.3}}, 300);
  std::vector<Pose> poses = smooth_path(random, {{498, -203, -1}, {505, -197, 2}}, 70);
  double radius = 0.15;

  explicit SceneOfGrid(std::size_t count = 5000) {
    points = quantise(random_points(random, {{496, -205, -1}, {506, -195, 2}}, count), kMillimetre);
  }

  Query query() const { return {model, poses, {.radius = radius}}; }

  /// The number of points that the run answers wrongly.
  std::uint64_t wrong(const GridRun& run, const MemoryCloudOptions& packing,
                      GridStatistics* statistics = nullptr) const {
    const auto expected = brute_force_first_poses(positions_of(points, kMillimetre), query());
    const MemoryCloud cloud(points, kMillimetre, packing);
    std::uint64_t count = 0;
    const HitSet hits = run_grid(cloud, query(), run, statistics);
    for (std::uint64_t slot = 0; slot < cloud.entry_count(); ++slot) {
      const bool used = cloud.is_used(slot);
      count += hits.contains(slot) != (used && expected[cloud.source(slot)] != kNoPose);
    }
    return count;
  }
};

}  // namespace

TEST_CASE("grid cells from tiny to huge") {
  const SceneOfGrid scene;
  for (double size = 1e-9; size < 1e9; size *= 10) {
    CAPTURE(size);
    check_equal(scene.wrong({.options = {.grid_cell = size}}, {1000, 0}), 0);
  }
}

TEST_CASE("a work list of one pair, and of few") {
  const SceneOfGrid scene;
  for (const std::uint32_t work_list : {0, 1, 2, 31, 513}) {
    CAPTURE(work_list);
    check_equal(scene.wrong({.work_list = work_list}, {1000, 0}), 0);
  }
}

TEST_CASE("pages of one cell and of all, one slot and many") {
  const SceneOfGrid scene;
  for (const std::uint32_t cells : {1, 2, 100}) {
    for (const std::uint32_t slots : {1, 5}) {
      check_equal(scene.wrong({.slots = slots, .cells_a_page = cells}, {256, 700}), 0);
    }
  }
}

TEST_CASE("a model of several tasks") {
  // The model has more parts than one task looks at, and the last one is short.
  SceneOfGrid scene(300);
  scene.model = random_points(scene.random, {{-1, -1, -0.3}, {1, 1, 0.3}},
                              kTaskParts * kPartGroups * kGroupPoints + 5000);
  scene.poses.resize(3);
  GridStatistics statistics;
  check_equal(scene.wrong({}, {128, 0}, &statistics), 0);
  CHECK(statistics.searches > 0);
}

TEST_CASE("a sparse cell takes no more memory, and its clusters are searched in grid cells") {
  // Clusters of a metre over 100 km: a dense grid would have 1e18 cells.
  SceneOfGrid scene(0);
  const double distances[] = {0, 40'000, 100'000};
  for (const double far : distances) {
    for (const Vec3& p : random_points(scene.random, {{498, -203, -1}, {502, -199, 2}}, 2000)) {
      scene.points.push_back(quantise(std::vector{Vec3{p.x + far, p.y, p.z}}, kMillimetre)[0]);
    }
  }
  GridStatistics statistics;
  check_equal(scene.wrong({}, {65536, 0}, &statistics), 0);
  CHECK(statistics.searches > 0);
  // Testing a third of the points would be 2,000 tests a search.
  CHECK(statistics.point_tests < 100 * statistics.searches);
}

TEST_CASE("most searches end at a bit, and few pairs need the predicate") {
  const SceneOfGrid scene;
  GridStatistics statistics;
  scene.wrong({}, {1000, 0}, &statistics);
  CHECK(statistics.points_moved < 2 * scene.model.size() * scene.poses.size());
  CHECK(statistics.searches < statistics.points_moved);
  CHECK(statistics.exact_tests * 1000 < statistics.point_tests);
}

TEST_CASE("every pose of a page's nodes belongs to one task") {
  const SceneOfGrid scene(2000);
  const MemoryCloud cloud(scene.points, kMillimetre, {256, 0});
  const Query query = scene.query();
  const MotionTree motion(scene.poses, ModelGroups(scene.model).box());
  const GridScene grid(query, motion, cloud);
  std::vector<int> times(scene.poses.size());
  for (const std::uint32_t run : grid.runs()) {
    CHECK(grid.nodes()[run].count <= kRunPoses);
    for (std::uint32_t i = 0; i < grid.nodes()[run].count; ++i)
      ++times[grid.nodes()[run].first + i];
  }
  CHECK(times == std::vector<int>(scene.poses.size(), 1));
  for (const GridNode& node : grid.nodes()) {
    if (node.count <= kRunPoses) continue;
    const GridNode& first = grid.nodes()[grid.runs()[node.first_run]];
    const GridNode& last = grid.nodes()[grid.runs()[node.first_run + node.runs - 1]];
    CHECK(first.first == node.first);
    CHECK(last.first + last.count == node.first + node.count);
  }
}

TEST_CASE("the grid cell chosen follows radius and density") {
  CHECK(cheapest_grid_cell(0.1, 0) >= 0.2);     // looking up is the whole cost
  CHECK(cheapest_grid_cell(0.1, 1e7) <= 0.05);  // testing points is the whole cost
  CHECK(cheapest_grid_cell(1, 100) == 10 * cheapest_grid_cell(0.1, 10'000));
  for (double density = 1; density < 1e7; density *= 3) {
    CHECK(cheapest_grid_cell(0.1, density) >= cheapest_grid_cell(0.1, 3 * density));
  }
  Random random(2);
  const auto plane =
      quantise(random_points(random, {{500, -200, 0}, {510, -190, 0}}, 100'000), kMillimetre);
  const double density = surface_density(MemoryCloud(plane, kMillimetre));
  CHECK(density > 700);  // the true density is 1000 a square metre
  CHECK(density < 2000);
  check_equal(surface_density(MemoryCloud({}, kMillimetre)), 0);
}
