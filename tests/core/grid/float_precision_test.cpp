// `--precision float` against brute force in floats alone, which gives the same wrong answers
// everywhere.
#include <cmath>

#include "core/grid/float_predicate.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/engines/brute_force.hpp"
#include "support/engines/grid_runs.hpp"
#include "support/memory_cloud.hpp"
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
  const Quantisation quantisation{{1e-3, 1e-3, 1e-3}, {origin.x, origin.y, origin.z}};
  const Box room{{origin.x, origin.y, origin.z}, {origin.x + 5, origin.y + 5, origin.z + 2}};
  const auto points = quantise(random_points(random, room, 3000), quantisation);
  const auto positions = positions_of(points, quantisation);
  const auto model = random_points(random, {{-0.5, -0.4, -0.3}, {0.5, 0.4, 0.3}}, 200);
  const auto poses = smooth_path(random, room, 20);
  const Query query{model, poses, {.radius = radius}};
  const auto exact = brute_force_first_poses(positions, query);

  const MemoryCloud cloud(points, quantisation, {512, 0});
  const HitSet hits = run_grid(cloud, query, {.options = {.precision = GridPrecision::kFloat}});
  Counts counts;
  std::uint64_t wrong = 0;
  for (std::uint64_t slot = 0; slot < cloud.entry_count(); ++slot) {
    if (!cloud.is_used(slot)) continue;
    bool expected = false;
    for (const Pose& pose : poses) {
      for (const Vec3& m : model) {
        expected = expected || collides_in_float(positions[cloud.source(slot)], pose, m, radius);
      }
    }
    wrong += hits.contains(slot) != expected;
    counts.hits += expected;
    counts.differing += expected != (exact[cloud.source(slot)] != kNoPose);
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
