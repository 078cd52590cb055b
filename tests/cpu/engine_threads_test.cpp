// Every engine where threads get in each other's way.
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/engines/engines.hpp"
#include "support/scenes.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("points that are each touched by exactly one pose lose no hit") {
  // Points on a line. The model is a comb: pose i touches point i of every `teeth`, so that poses
  // searched at the same time touch points that are neighbours in memory.
#ifdef CLEARWAY_SANITIZED
  constexpr std::int32_t kPoints = 1 << 14;
#else
  constexpr std::int32_t kPoints = 1 << 17;
#endif
  const Quantisation quantisation{{1, 1, 1}, {0, 0, 0}};
  std::vector<Quantum> points;
  for (std::int32_t i = 0; i < kPoints; ++i) points.push_back({i, 0, 0});
  const MemoryCloud cloud(points, quantisation);
  for (const std::int32_t teeth : {32, 128, 512, 2048, 128, 512}) {
    const std::int32_t pitch = kPoints / teeth;
    std::vector<Vec3> model;
    std::vector<Pose> poses;
    for (std::int32_t i = 0; i < teeth; ++i) model.push_back({1.0 * i * pitch, 0, 0.1});
    for (std::int32_t i = 0; i < pitch; ++i) poses.push_back(translation({1.0 * i, 0.1, 0}));
    for (const Engine& engine : engines()) {
      CAPTURE(engine.name, teeth);
      CHECK(engine.run(cloud, {model, poses, {0.25}}, 8).hits.count() == kPoints);
    }
  }
}

TEST_CASE("the answer does not depend on the number of threads") {
  Random random(3);
  const Box room{{0, 0, 0}, {10, 3, 3}};
  const Quantisation quantisation{{1e-3, 1e-3, 1e-3}, {0, 0, 0}};
  const MemoryCloud cloud(quantise(random_points(random, room, 20'000), quantisation), quantisation,
                          {1000, 0});
  const auto model = random_points(random, {{-1, -1, -1}, {1, 1, 1}}, 300);
  const auto poses = smooth_path(random, room, 200);
  for (const Engine& engine : engines()) {
    const Query query{model, poses, {0.1, engine.finds_all}};
    const HitSet expected = engine.run(cloud, query, 1).hits;
    CHECK(expected.count() > 1000);
    for (const int threads : {0, 2, 5, 16}) {
      const HitSet hits = engine.run(cloud, query, threads).hits;
      CAPTURE(engine.name, threads);
      std::uint64_t differing = 0;
      for (std::uint64_t slot = 0; slot < cloud.entry_count(); ++slot) {
        differing += hits.contains(slot) != expected.contains(slot);
        if (engine.finds_all) differing += hits.first_pose(slot) != expected.first_pose(slot);
      }
      check_equal(differing, 0);
    }
  }
}
