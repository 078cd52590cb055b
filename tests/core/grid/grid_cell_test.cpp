// The bounds of a cell's filters, attacked by pairs at the radius: docs/design/numerics.md, "Grid".
#include "core/grid/grid_cell.hpp"

#include <cmath>

#include "core/geometry/predicate.hpp"
#include "core/grid/grid_search.hpp"
#include "support/catch.hpp"
#include "support/memory_cloud.hpp"
#include "support/random_triangles.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// A cloud of one cell and a scene that searches it.
struct OneCell {
  OneCell(std::vector<Quantum> points, const Quantisation& quantisation, double radius,
          double grid_cell = 0)
      : cloud(points, quantisation),
        query{model, poses, {radius}},
        motion(poses, {{}, {}}),
        scene(query, motion, cloud, {.grid_cell = grid_cell}),
        grid(make_grid_cell(scene, cloud.cells()[0].box, cloud.cells()[0].count)) {}

  std::vector<Vec3> model{{0, 0, 0}};
  std::vector<Pose> poses{translation({0, 0, 0})};
  MemoryCloud cloud;
  Query query;
  MotionTree motion;
  GridScene scene;
  GridCell grid;
};

struct Tally {
  std::uint64_t hits = 0, misses = 0, accepted = 0, dismissed = 0;
};

/// Checks that what every filter says of the pair agrees with the predicate.
void check_pair(const OneCell& cell, const Vec3& e, const Vec3& m, Tally& tally) {
  const GridCell& grid = cell.grid;
  const GridPoint p = rebased(grid, e, 0), x = rebased(grid, m, 0);
  const float dx = p.x - x.x, dy = p.y - x.y, dz = p.z - x.z;
  const float squared = dx * dx + dy * dy + dz * dz;
  const bool hit = collides(e, m, cell.query.radius);
  const bool outside = squared > grid.outer_squared;
  const bool inside = squared < grid.inner_squared;
  ++(hit ? tally.hits : tally.misses);
  tally.accepted += inside;
  tally.dismissed += outside;
  if (inside) REQUIRE(hit);
  if (!hit) return;
  REQUIRE(!outside);
  const float of_p[] = {p.x, p.y, p.z}, of_x[] = {x.x, x.y, x.z};
  for (int k = 0; k < 3; ++k) {
    REQUIRE(of_x[k] >= -grid.reach);
    REQUIRE(of_x[k] <= grid.extent[k] + grid.reach);
    const int at = grid_step(of_p[k], grid.per_bucket);
    REQUIRE(grid_step(of_x[k] - grid.reach, grid.per_bucket) <= at);
    REQUIRE(grid_step(of_x[k] + grid.reach, grid.per_bucket) >= at);
  }
  std::vector<std::uint64_t> words(4096);
  mark_around(words.data(), 4096, grid.per_bit, grid.reach, p);
  REQUIRE(is_marked(words.data(), 4096, grid.per_bit, x.x, x.y, x.z));
}

std::vector<Quantum> corners(std::int32_t quanta) {
  return {{0, 0, 0}, {quanta, quanta, quanta}, {quanta / 3, quanta, quanta / 2}};
}

}  // namespace

TEST_CASE("filters agree with the predicate for pairs around the radius") {
  Random random(21);
  Tally tally;
  for (int trial = 0; trial < 400; ++trial) {
    const double far = trial % 3 == 0 ? 0 : trial % 3 == 1 ? 5e6 : 1e12;
    const double scale = std::exp2(std::floor(uniform(random, -20, 0))) * (far > 1e9 ? 1e3 : 1);
    const Quantisation quantisation{{scale, scale, scale}, {far, -far, 0.3 * far}};
    const auto quanta = static_cast<std::int32_t>(std::exp2(uniform(random, 0, 30.9)));
    const double extent = quanta * scale;
    const double radius = extent * std::exp(uniform(random, -18, 4));
    const OneCell cell(corners(quanta), quantisation, radius, radius * uniform(random, 0.01, 20));
    REQUIRE(!cell.grid.exact_only);
    for (int i = 0; i < 60; ++i) {
      Quantum q;
      for (int k = 0; k < 3; ++k) {
        q[k] = static_cast<std::int32_t>(below(random, static_cast<std::uint64_t>(quanta) + 1));
        if (below(random, 4) == 0) q[k] = below(random, 2) == 0 ? 0 : quanta;
      }
      const Vec3 e = position(quantisation, q[0], q[1], q[2]);
      Vec3 direction = random_direction(random);
      if (i % 5 == 0) direction = {i % 2 == 0 ? 1.0 : -1.0, 0, 0};
      const double off = std::pow(10, uniform(random, -12, 0)) * (i % 2 == 0 ? 1 : -1);
      check_pair(cell, e, plus(e, radius * (1 + off), direction), tally);
    }
  }
  CHECK(tally.hits > 5000);
  CHECK(tally.misses > 5000);
  CHECK(tally.accepted > 2000);
  CHECK(tally.dismissed > 2000);
}

TEST_CASE("pairs one float rounding around the bounds of a cell") {
  // The bound is tightest at the farthest corner, where rebasing rounds most.
  Random random(22);
  Tally tally;
  const double scale = 0x1p-30;
  for (const std::int32_t quanta : {1 << 24, (1 << 24) + 1, 1 << 30, (1 << 30) + 12345}) {
    const Quantisation quantisation{{scale, scale, scale}, {0, 0, 0}};
    const double extent = quanta * scale;
    for (const double of_extent : {1e-7, 1e-6, 1e-3, 0.1, 1.0, 30.0}) {
      const double radius = extent * of_extent;
      const OneCell cell(corners(quanta), quantisation, radius);
      for (int i = 0; i < 2000; ++i) {
        Vec3 e{};
        for (int k = 0; k < 3; ++k) {
          e[k] = extent * (1 - std::floor(uniform(random, 0, 1000)) * 0x1p-30);
        }
        const double off = uniform(random, -1e-6, 1e-6) * (extent + radius) / radius;
        check_pair(cell, e, plus(e, radius * (1 + off), random_direction(random)), tally);
      }
    }
  }
  CHECK(tally.hits > 5000);
  CHECK(tally.accepted > 500);
  CHECK(tally.dismissed > 500);
}

TEST_CASE("a group's centre within the group radius of a point finds its bit") {
  Random random(23);
  for (int trial = 0; trial < 300; ++trial) {
    const double scale = std::exp2(std::floor(uniform(random, -20, 0)));
    const Quantisation quantisation{{scale, scale, scale}, {5e6, -2e6, 10}};
    const auto quanta = static_cast<std::int32_t>(std::exp2(uniform(random, 4, 30.9)));
    const double extent = quanta * scale;
    const OneCell cell(corners(quanta), quantisation, extent * std::exp(uniform(random, -9, 3)));
    const GridCell& grid = cell.grid;
    std::vector<std::uint64_t> words(64);
    const Quantum q = corners(quanta)[below(random, 3)];
    const Vec3 e = position(quantisation, q[0], q[1], q[2]);
    mark_around(words.data(), 64, grid.per_group_bit, grid.group_reach, rebased(grid, e, 0));
    for (int i = 0; i < 100; ++i) {
      const Vec3 along{i % 8 == 0 ? 1.0 : -1.0, 0, 0};
      const Vec3 to = i % 4 == 0 ? along : random_direction(random);
      const GridPoint x = rebased(grid, plus(e, grid.group_radius * (1 - 1e-9), to), 0);
      REQUIRE(is_marked(words.data(), 64, grid.per_group_bit, x.x, x.y, x.z));
    }
  }
}

TEST_CASE("bits of the occupancy stay few around a point") {
  const Quantisation quantisation{{1e-3, 1e-3, 1e-3}, {0, 0, 0}};
  const OneCell cell(corners(2000), quantisation, 0.1);
  std::vector<std::uint64_t> words(4096);
  mark_around(words.data(), 4096, cell.grid.per_bit, cell.grid.reach,
              rebased(cell.grid, {1, 1, 1}, 0));
  Random random(24);
  int marked = 0;
  for (int i = 0; i < 10000; ++i) {
    const GridPoint x = rebased(cell.grid, random_point(random, {{0, 0, 0}, {2, 2, 2}}), 0);
    marked += is_marked(words.data(), 4096, cell.grid.per_bit, x.x, x.y, x.z);
  }
  CHECK(marked > 0);
  CHECK(marked < 60);  // (0.25 / 2)^3 of 10,000 is 20
}

TEST_CASE("lengths that floats cannot hold are left to the predicate") {
  const Quantisation quantisation{{1, 1, 1}, {0, 0, 0}};
  CHECK(OneCell(corners(100), quantisation, 1e200).grid.exact_only);
  CHECK(OneCell(corners(100), {{1e12, 1e12, 1e12}, {0, 0, 0}}, 1).grid.exact_only == false);
  CHECK(OneCell(corners(100), {{1e14, 1e14, 1e14}, {0, 0, 0}}, 1).grid.exact_only);
}
