// Tests of what only the engines grid and kdtree have: options, work list, pages, statistics.
#include <cmath>

#include "clearway/error.hpp"
#include "core/grid/grid_cell.hpp"
#include "core/grid/grid_search.hpp"
#include "core/grid/grid_size.hpp"
#include "cpu/kdtree_engine.hpp"
#include "stream/plan.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/engines/engines.hpp"
#include "support/engines/grid_runs.hpp"
#include "support/memory_cloud.hpp"
#include "support/scenes.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

const Quantisation kMillimetre{{1e-3, 1e-3, 1e-3}, {500, -200, 0}};

struct SceneOfGrid : EngineScene {
  explicit SceneOfGrid(std::size_t count = 5000) {
    quantisation = kMillimetre;
    query = {random_points(random, {{-0.5, -0.4, -0.3}, {0.5, 0.4, 0.3}}, 300),
             smooth_path(random, {{498, -203, -1}, {505, -197, 2}}, 70),
             {.radius = 0.15}};
    add_points(random_points(random, {{496, -205, -1}, {506, -195, 2}}, count));
  }

  void add_points(const std::vector<Vec3>& places) {
    for (const Quantum& q : quantise(places, quantisation)) points.push_back(q);
  }

  /// What a run counts, after a check of its answer.
  GridStatistics checked(const MemoryCloudOptions& packing) const {
    const MemoryCloud cloud(points, quantisation, packing);
    GridStatistics statistics;
    check_equal(Expected(*this).wrong(run_grid(cloud, query, {}, &statistics), cloud, query), 0);
    CHECK(statistics.searches > 0);
    return statistics;
  }

  Random random{9};
};

}  // namespace

TEST_CASE("the answer depends on no grid cell, work list, page or slot") {
  const SceneOfGrid scene;
  const MemoryCloud cloud(scene.points, kMillimetre, {256, 700});
  const Expected expected(scene);
  std::vector<GridRun> runs;
  for (double size = 1e-9; size < 1e9; size *= 10) {
    runs.push_back({.options = {.grid_cell = size}});
  }
  for (const std::uint32_t pairs : {0, 1, 2, 31, 513}) runs.push_back({.work_list = pairs});
  for (const std::uint32_t cells : {1, 2, 100}) {
    for (const std::uint32_t slots : {1, 5}) {
      const GridRun run{.slots = slots, .cells_a_page = cells};
      runs.push_back(run);
      check_equal(expected.wrong(run_kdtree(cloud, scene.query, run), cloud, scene.query), 0);
    }
  }
  for (const GridRun& run : runs) {
    CAPTURE(run.options.grid_cell, run.work_list, run.cells_a_page, run.slots);
    check_equal(expected.wrong(run_grid(cloud, scene.query, run), cloud, scene.query), 0);
  }
}

TEST_CASE("a model of several tasks") {
  // The model has more parts than one task looks at, and the last one is short.
  SceneOfGrid scene(300);
  scene.query.model = random_points(scene.random, {{-1, -1, -0.3}, {1, 1, 0.3}},
                                    kTaskParts * kPartGroups * kGroupPoints + 5000);
  scene.query.poses.resize(3);
  scene.checked({128, 0});
}

TEST_CASE("a sparse cell takes no more memory, and its clusters are searched in grid cells") {
  // Clusters of a metre over 100 km: a dense grid would have 1e18 cells.
  SceneOfGrid scene(0);
  for (const double far : {0, 40'000, 100'000}) {
    scene.add_points(
        random_points(scene.random, {{far + 498, -203, -1}, {far + 502, -199, 2}}, 2000));
  }
  const GridStatistics statistics = scene.checked({65536, 0});
  // Testing a third of the points would be 2,000 tests a search.
  CHECK(statistics.point_tests < 100 * statistics.searches);
}

TEST_CASE("most searches end at a bit, and few pairs need the predicate") {
  const SceneOfGrid scene;
  const GridStatistics statistics = scene.checked({1000, 0});
  CHECK(statistics.points_moved < 2 * scene.query.model.vertices.size() * scene.query.poses.size());
  CHECK(statistics.searches < statistics.points_moved);
  CHECK(statistics.exact_tests * 1000 < statistics.point_tests);
}

TEST_CASE("every pose of a page's nodes belongs to one task") {
  const SceneOfGrid scene(2000);
  const MemoryCloud cloud(scene.points, kMillimetre, {256, 0});
  const MotionTree motion(scene.query.poses, ModelGroups(scene.query.model.vertices).box());
  const GridScene grid(scene.query, motion, cloud);
  std::vector<int> times(scene.query.poses.size());
  for (const std::uint32_t run : grid.runs()) {
    CHECK(grid.nodes()[run].count <= kRunPoses);
    for (std::uint32_t i = 0; i < grid.nodes()[run].count; ++i)
      ++times[grid.nodes()[run].first + i];
  }
  CHECK(times == std::vector<int>(scene.query.poses.size(), 1));
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

TEST_CASE("kdtree: searches are counted, and far parts dismissed") {
  const SceneOfGrid scene(200'000);
  const Query& query = scene.query;
  const MemoryCloud cloud(scene.points, kMillimetre);
  const MotionTree motion(query.poses, Box{{-1, -1, -1}, {1, 1, 1}});
  const SpheresOnPath path(query, motion);
  const std::vector<PlannedCell> cells{{0, {0}}};
  KdTreeEngine engine(cloud, path, {2, smallest_page_bytes(cloud, cells), 1});
  stage_page(cloud, cells, engine.page(1));
  engine.start(1, page_shape(cloud, cells, false));
  CHECK(engine.tested_searches() > 0);
  CHECK(engine.tested_searches() < query.poses.size() * query.model.vertices.size());
}

TEST_CASE("kdtree: a path whose steps halve again and again is searched down to its last pose") {
  // The tree over these poses is a list, and only its end touches the points.
  Query query{{{0, 0, 0}}, {}, {.radius = 1e-3 * (1 + 1e-13)}};
  for (int i = 0; i < 400; ++i) query.poses.push_back(translation({std::ldexp(8, -i), 0, 0}));
  const std::vector<Quantum> points(2000, Quantum{-1000, 0, 0});
  const MemoryCloud cloud(points, {{1e-6, 1e-6, 1e-6}, {0, 0, 0}});
  check_equal(run_kdtree(cloud, query, {}).hits.count(), points.size());
}
