// Tests of what only the kdtree engine promises.
#include "cpu/kdtree_engine.hpp"

#include <cmath>

#include "stream/plan.hpp"
#include "stream/run_pages.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/engines/grid_runs.hpp"
#include "support/memory_cloud.hpp"
#include "support/scenes.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("searches are counted, and far parts dismissed") {
  Random random{1};
  const Box room{{0, 0, 0}, {40, 20, 5}};
  const Quantisation quantisation{{1e-3, 1e-3, 1e-3}, {0, 0, 0}};
  const MemoryCloud cloud(quantise(random_points(random, room, 200'000), quantisation),
                          quantisation);
  const Query query{
      random_points(random, {{-1, -1, -1}, {1, 1, 1}}, 500), smooth_path(random, room, 100), {0.1}};
  const MotionTree motion(query.poses, Box{{-1, -1, -1}, {1, 1, 1}});
  const SpheresOnPath path(query, motion);
  const std::vector<PlannedCell> cells{{0, {0}}};
  const std::uint64_t page_bytes = smallest_page_bytes(cloud, cells);
  KdTreeEngine engine(cloud, path, {2, page_bytes, 1});
  stage_page(cloud, cells, engine.page(1));
  engine.start(1, page_shape(cloud, cells, false));
  CHECK(engine.tested_searches() > 0);
  CHECK(engine.tested_searches() < query.poses.size() * query.model.vertices.size());
}

TEST_CASE("pages of one cell and of all, one slot and many") {
  Random random{2};
  const Box room{{0, 0, 0}, {10, 5, 3}};
  const Quantisation quantisation{{1e-3, 1e-3, 1e-3}, {0, 0, 0}};
  const MemoryCloud cloud(quantise(random_points(random, room, 5000), quantisation), quantisation,
                          {256, 700});
  const Query query{
      random_points(random, {{-1, -1, -1}, {1, 1, 1}}, 300), smooth_path(random, room, 70), {0.1}};
  const std::uint64_t expected = run_grid(cloud, query, {}).count();
  CHECK(expected > 100);
  for (const std::uint32_t cells : {1, 2, 100}) {
    for (const std::uint32_t slots : {1, 5}) {
      check_equal(run_kdtree(cloud, query, {.slots = slots, .cells_a_page = cells}).count(),
                  expected);
    }
  }
}

TEST_CASE("a path whose steps halve again and again is searched down to its last pose") {
  // The tree over these poses is a list, and only its end touches the points.
  Query query{std::vector<Vec3>{{0, 0, 0}}, {}, {.radius = 1e-3 * (1 + 1e-13)}};
  for (int i = 0; i < 400; ++i) query.poses.push_back(translation({std::ldexp(8, -i), 0, 0}));
  const std::vector<Quantum> points(2000, Quantum{-1000, 0, 0});
  const MemoryCloud cloud(points, {{1e-6, 1e-6, 1e-6}, {0, 0, 0}});
  check_equal(run_kdtree(cloud, query, {}).count(), points.size());
}
