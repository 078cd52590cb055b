// Places near a path, against every segment by the definition alone.
#include "core/trajectory/corridor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "support/catch.hpp"
#include "support/scenes.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

double squared_by_definition(const std::vector<Vec3>& path, const Vec3& p) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < std::max<std::size_t>(1, path.size() - 1); ++i) {
    const Vec3 a = path[i], b = path[std::min(i + 1, path.size() - 1)];
    const double wx = b.x - a.x, wy = b.y - a.y, wz = b.z - a.z;
    double t = 0;
    if (!(a == b)) {
      const double along = (p.x - a.x) * wx + (p.y - a.y) * wy + (p.z - a.z) * wz;
      t = std::min(1.0, std::max(0.0, along / (wx * wx + wy * wy + wz * wz)));
    }
    const double x = p.x - (a.x + t * wx), y = p.y - (a.y + t * wy), z = p.z - (a.z + t * wz);
    least = std::min(least, x * x + y * y + z * z);
  }
  return least;
}

/// A path of 1 to 60 positions: straight, wandering, with repeated positions, closed, or on a
/// lattice, where ties are frequent.
std::vector<Vec3> random_path(Random& random, const Vec3& origin, bool lattice) {
  std::vector<Vec3> path{origin};
  const std::uint64_t count = 1 + below(random, 60);
  for (std::uint64_t i = 1; i < count; ++i) {
    Vec3 next = path.back();
    if (below(random, 5) != 0) {
      for (int k = 0; k < 3; ++k) {
        next[k] += lattice ? static_cast<double>(below(random, 3)) - 1 : uniform(random, -0.6, 0.8);
      }
    }
    path.push_back(next);
  }
  if (below(random, 4) == 0) path.push_back(path.front());
  return path;
}

}  // namespace

TEST_CASE("a corridor holds the places that the definition says") {
  Random random(20261127);
  std::size_t held = 0, ties = 0;
  for (int scene = 0; scene < 300; ++scene) {
    const bool lattice = scene % 3 == 0;
    const Vec3 origin = scene % 2 == 0 ? Vec3{0, 0, 0} : Vec3{448'262, 5'421'877, 312};
    const std::vector<Vec3> path = random_path(random, origin, lattice);
    const double within = lattice ? 2 : uniform(random, 0.1, 3);
    const Corridor corridor(path, within);
    CorridorWalk walk(corridor);
    INFO("scene " << scene);
    Vec3 p = origin;
    for (int i = 0; i < 300; ++i) {
      const double step = i % 40 == 1 ? 20 : 0.3;
      if (i % 20 == 0) p = path[below(random, path.size())];
      for (int k = 0; k < 3; ++k) {
        p[k] = lattice ? origin[k] + static_cast<double>(below(random, 13)) - 6
                       : p[k] + step * uniform(random, -1, 1);
      }
      const double squared = squared_by_definition(path, p);
      const bool expected = squared <= within * within;
      CHECK(corridor.squared_distance(p) == squared);
      CHECK(corridor.holds(p) == expected);
      CHECK(walk.holds(p) == expected);
      CHECK(corridor.distance_above(p) >= std::sqrt(squared));
      if (expected) CHECK(corridor.may_hold({p, p}));
      if (expected) CHECK(corridor.may_hold(Box{p, p}.grown(0.2)));
      held += expected ? 1 : 0;
      ties += squared == within * within ? 1 : 0;
    }
  }
  CHECK(held > 10'000);
  CHECK(ties > 100);
}

TEST_CASE("a box far from a path is told from one beside it") {
  const Corridor corridor({{0, 0, 0}, {10, 0, 0}, {10, 10, 0}}, 1);
  CHECK(corridor.may_hold({{4, 0.9, -1}, {5, 3, 1}}));
  CHECK_FALSE(corridor.may_hold({{4, 1.1, -1}, {5, 3, 1}}));
  CHECK_FALSE(corridor.may_hold({{0, 5, -1}, {8.9, 9, 1}}));
}
