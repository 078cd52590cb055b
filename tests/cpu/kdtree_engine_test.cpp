// Tests of what only the kdtree engine promises.
#include "cpu/kdtree_engine.hpp"

#include <atomic>

#include "clearway/error.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/memory_cloud.hpp"
#include "support/scenes.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

struct CountedProgress final : Progress {
  void begin(std::string_view, std::uint64_t expected, std::string_view) override {
    total = expected;
    ++begun;
  }
  void advance(std::uint64_t units) override { done += units; }
  void end() override { ++ended; }

  std::uint64_t total = 0;
  std::atomic<std::uint64_t> done = 0;
  int begun = 0, ended = 0;
};

struct SceneOfTree {
  Random random{1};
  Box room{{0, 0, 0}, {40, 20, 5}};
  Quantisation quantisation{{1e-3, 1e-3, 1e-3}, {0, 0, 0}};
  MemoryCloud cloud{quantise(random_points(random, room, 200'000), quantisation), quantisation};
  std::vector<Vec3> model = random_points(random, {{-1, -1, -1}, {1, 1, 1}}, 500);
  std::vector<Pose> poses = smooth_path(random, room, 100);
  Query query{model, poses, {0.1}};
};

}  // namespace

TEST_CASE("memory beyond the packed points is less than a byte a point") {
  const SceneOfTree scene;
  NoProgress progress;
  KdTreeStatistics statistics;
  run_kdtree(scene.cloud, scene.query, {2}, progress, &statistics);
  const std::uint64_t block_boxes = scene.cloud.blocks().size() * sizeof(BlockBox);
  CHECK(statistics.allocated_bytes + block_boxes < scene.cloud.point_count());
  CHECK(statistics.cache_bytes < 2 * (std::uint64_t{4} << 20));
}

TEST_CASE("searches are counted, and far parts dismissed") {
  const SceneOfTree scene;
  NoProgress progress;
  KdTreeStatistics statistics;
  run_kdtree(scene.cloud, scene.query, {2}, progress, &statistics);
  CHECK(statistics.searches == scene.poses.size() * scene.model.size());
  CHECK(statistics.tested_searches > 0);
  CHECK(statistics.tested_searches <= statistics.searches);
}

TEST_CASE("progress counts every pose once") {
  SceneOfTree scene;
  CountedProgress progress;
  SECTION("many poses") {}
  SECTION("one pose, its model shared out") { scene.query.poses.resize(1); }
  SECTION("no model") { scene.query.model = {}; }
  const std::uint64_t searches = scene.query.model.vertices.size() * scene.query.poses.size();
  run_kdtree(scene.cloud, scene.query, {3}, progress);
  check_equal(progress.begun, 1);
  check_equal(progress.ended, 1);
  CHECK(progress.total == scene.query.poses.size());
  CHECK(progress.done == (searches == 0 ? 0 : progress.total));
}

TEST_CASE("a damaged cell ends the run with its error") {
  SceneOfTree scene;
  const std::vector<Pose> poses(500, translation({20, 10, 2}));
  scene.query.poses = poses;
  scene.query.radius = 0.3;
  NoProgress progress;
  bool met = false;
  for (std::uint32_t cell = 0; cell < scene.cloud.cells().size(); ++cell) {
    scene.cloud.damage(cell);
    try {
      run_kdtree(scene.cloud, scene.query, {4}, progress);
    } catch (const InputError& error) {
      met = true;
      CHECK(std::string(error.what()) == "memory: cell " + std::to_string(cell) + " is damaged");
    }
  }
  CHECK(met);
}
