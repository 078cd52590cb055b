#include "core/geometry/box.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "support/scenes.hpp"

using namespace clearway;

namespace {

/// A random point of the box, on its border in about half of the axes.
Vec3 point_of(Random& random, const Box& box) {
  Vec3 p = random_point(random, box);
  for (int k = 0; k < 3; ++k) {
    const std::uint64_t kind = below(random, 4);
    if (kind == 0) p[k] = box.lo[k];
    if (kind == 1) p[k] = box.hi[k];
    p[k] = std::clamp(p[k], box.lo[k], box.hi[k]);
  }
  return p;
}

Box random_box(Random& random, const Vec3& at, double size) {
  Box box{};
  for (int k = 0; k < 3; ++k) {
    box.lo[k] = at[k] + uniform(random, -size, size);
    box.hi[k] = below(random, 3) == 0 ? box.lo[k] : box.lo[k] + uniform(random, 0, size);
  }
  return box;
}

void nudge(Random& random, Vec3& p) {
  for (int k = 0; k < 3; ++k) {
    const std::uint64_t steps = below(random, 4);
    for (std::uint64_t i = 0; i < steps; ++i) p[k] = std::nextafter(p[k], i % 2 == 0 ? 1e9 : -1e9);
  }
}

}  // namespace

TEST_CASE("box bounds hold for the computed d2 itself, to the last bit") {
  Random random(1);
  std::uint64_t wrong = 0, tight = 0;
  for (int trial = 0; trial < 200'000; ++trial) {
    const double far = trial % 3 == 0 ? 0 : trial % 3 == 1 ? 1e3 : 5e6;
    const double size = std::exp(uniform(random, -20, 3));
    const Vec3 at{far, -far, far / 5e3};
    const Box box = random_box(random, at, size);
    Vec3 m = point_of(random, random_box(random, at, 2 * size));
    if (trial % 5 == 0) m = point_of(random, box);
    nudge(random, m);
    const double least = least_squared_distance(box, m);
    const double greatest = greatest_squared_distance(box, m);
    for (int i = 0; i < 8; ++i) {
      const double d2 = squared_distance(point_of(random, box), m);
      wrong += d2 < least;
      wrong += d2 > greatest;
      tight += d2 == least;
    }
  }
  CHECK(wrong == 0);
  CHECK(tight > 10'000);
}

TEST_CASE("box bounds are the distances to the nearest and the farthest corner") {
  Random random(2);
  for (int trial = 0; trial < 2'000; ++trial) {
    const Box box = random_box(random, {1, 2, 3}, 1);
    const Vec3 m = random_point(random, {{-2, -2, -2}, {5, 5, 5}});
    Vec3 nearest{};
    double farthest = 0;
    for (int k = 0; k < 3; ++k) nearest[k] = std::clamp(m[k], box.lo[k], box.hi[k]);
    for (int i = 0; i < 8; ++i) {
      const Vec3 corner{i & 1 ? box.hi.x : box.lo.x, i & 2 ? box.hi.y : box.lo.y,
                        i & 4 ? box.hi.z : box.lo.z};
      farthest = std::max(farthest, squared_distance(corner, m));
    }
    CHECK(least_squared_distance(box, m) == squared_distance(nearest, m));
    CHECK(greatest_squared_distance(box, m) == farthest);
  }
}

TEST_CASE("a box of one point has its distance") {
  Random random(3);
  for (int trial = 0; trial < 2'000; ++trial) {
    const Vec3 e = random_point(random, {{-5, -5, -5}, {5e6, 5, 5}});
    const Vec3 m = random_point(random, {{-5, -5, -5}, {5e6, 5, 5}});
    CHECK(least_squared_distance({e, e}, m) == squared_distance(e, m));
    CHECK(greatest_squared_distance({e, e}, m) == squared_distance(e, m));
  }
}

TEST_CASE("a box is never dismissed or taken for a point that is not a number") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Box box{{1, 1, 1}, {2, 2, 2}};
  CHECK_FALSE(least_squared_distance(box, Vec3{nan, 1, 1}) > 0.5);
  CHECK_FALSE(greatest_squared_distance(box, {nan, 1, 1}) < 100.0);
  const double infinity = std::numeric_limits<double>::infinity();
  CHECK(least_squared_distance(box, Vec3{infinity, 1, 1}) == infinity);
  CHECK(greatest_squared_distance(box, {-infinity, 1, 1}) == infinity);
}
