// `--precision float` against brute force in floats alone, which gives the same wrong answers
// everywhere.
#include "core/grid/float_predicate.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/engines/engines.hpp"
#include "support/engines/grid_runs.hpp"
#include "support/scenes.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

struct Counts {
  std::uint64_t hits = 0;
  std::uint64_t differing = 0;  ///< number of answers that differ from the exact ones
};

Counts check_float(const Vec3& origin, double radius) {
  Random random(31);
  const Box room{{0, 0, 0}, {5, 5, 2}};
  EngineScene scene{{}, {{1e-3, 1e-3, 1e-3}, {0, 0, 0}}, {}};
  scene.points = quantise(random_points(random, room, 3000), scene.quantisation);
  scene.query = {random_points(random, {{-0.5, -0.4, -0.3}, {0.5, 0.4, 0.3}}, 200),
                 smooth_path(random, room, 20),
                 {.radius = radius}};
  scene.move_far_away(origin);
  const Expected exact(scene);
  const std::vector<Vec3> positions = positions_of(scene.points, scene.quantisation);
  const MemoryCloud cloud(scene.points, scene.quantisation, {512, 0});
  const HitSet hits =
      run_grid(cloud, scene.query, {.options = {.precision = GridPrecision::kFloat}}).hits;
  Counts counts;
  std::uint64_t wrong = 0;
  for (std::uint64_t entry = 0; entry < cloud.entry_count(); ++entry) {
    if (!cloud.is_used(entry)) continue;
    const std::uint64_t source = cloud.source(entry);
    const bool expected = std::ranges::any_of(scene.query.poses, [&](const Pose& pose) {
      return std::ranges::any_of(scene.query.model.vertices, [&](const Vec3& m) {
        return collides_in_float(positions[source], pose, m, radius);
      });
    });
    wrong += hits.contains(entry) != expected;
    counts.hits += expected;
    counts.differing += expected != (exact.first_poses(false)[source] != kNoPose);
  }
  check_equal(wrong, 0);
  return counts;
}

}  // namespace

TEST_CASE("floats alone decide by themselves, near the origin and far from it") {
  const Counts near = check_float({0, 0, 0}, 0.15);
  CHECK(near.hits > 100);
  const Counts far = check_float({5e6, 2e6, 100}, 0.15);
  CHECK(far.hits > 0);
  CHECK(far.differing > 10 * near.differing + 10);  // floats there are half a metre apart
  check_float({-1e4, 3e4, 0}, 0.3);
}
