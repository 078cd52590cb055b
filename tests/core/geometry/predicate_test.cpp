#include "core/geometry/predicate.hpp"

#include <cmath>
#include <random>

#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("the predicate is strict at the radius") {
  const Vec3 m{0, 0, 0};
  CHECK_FALSE(collides({0.1, 0, 0}, m, 0.1));
  CHECK(collides({std::nextafter(0.1, 0), 0, 0}, m, 0.1));
  CHECK_FALSE(collides({std::nextafter(0.1, 1), 0, 0}, m, 0.1));
}

TEST_CASE("no multiplication of the predicate is fused with an addition") {
  // x x is inexact; a fused x x + y y with y = 0 would not show, one with the error term does.
  const double x = 1 + 0x1p-30;
  const double rounded = x * x;
  REQUIRE(std::fma(x, x, -rounded) != 0);
  volatile double a = x;
  check_equal(rounded_sum(rounded_product(a, a), -rounded), 0);
  const Pose pose{{x, x, 0, 0, 1, 0, 0, 0, 1}, {-rounded, 0, 0}};
  const Vec3 moved = transform(pose, {x, 0, 0});
  check_equal(moved.x, 0);
}

TEST_CASE("the inside of a segment is strict at the radius and at both ends") {
  const Vec3 a{0, 0, 0}, b{1, 0, 0};
  CHECK(collides_inside({0.5, 0.25, 0}, a, b, std::nextafter(0.25, 1)));
  CHECK_FALSE(collides_inside({0.5, 0.25, 0}, a, b, 0.25));
  CHECK_FALSE(collides_inside({0, 0.1, 0}, a, b, 0.25));
  CHECK_FALSE(collides_inside({1, 0.1, 0}, a, b, 0.25));
  CHECK_FALSE(collides_inside({-0.1, 0, 0}, a, b, 0.25));
  CHECK_FALSE(collides_inside({1.1, 0, 0}, a, b, 0.25));
  CHECK(collides_inside({0x1p-60, 0.1, 0}, a, b, 0.25));
  CHECK(collides_inside({std::nextafter(1.0, 0), 0.1, 0}, a, b, 0.25));
}

TEST_CASE("a segment without a length has no inside") {
  const Vec3 e{0.1, 0, 0}, a{0, 0, 0};
  CHECK_FALSE(collides_inside(e, a, a, 1));
  CHECK_FALSE(collides_inside(e, a, {1e-170, 0, 0}, 1));             // D underflows to 0
  CHECK_FALSE(collides_inside(e, a, {1e200, 0, 0}, 0.01));           // D overflows, so w is ae
  CHECK_FALSE(collides_inside({1e200, 0, 0}, a, {1e200, 1, 0}, 1));  // n overflows
}

TEST_CASE("the inside of a segment in the order of its definition") {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(-1, 1);
  int inside = 0;
  for (int i = 0; i < 20'000; ++i) {
    double e[3], a[3], b[3], ab[3], ae[3], w[3];
    for (int k = 0; k < 3; ++k) {
      a[k] = 100 * unit(random);
      b[k] = a[k] + unit(random);
      e[k] = a[k] + unit(random);
      ab[k] = b[k] - a[k];
      ae[k] = e[k] - a[k];
    }
    const volatile double n0 = ae[0] * ab[0], n1 = ae[1] * ab[1], n2 = ae[2] * ab[2];
    const volatile double n01 = n0 + n1, n = n01 + n2;
    const volatile double d0 = ab[0] * ab[0], d1 = ab[1] * ab[1], d2 = ab[2] * ab[2];
    const volatile double d01 = d0 + d1, d = d01 + d2;
    const volatile double g = n / d;
    for (int k = 0; k < 3; ++k) {
      const volatile double along = g * ab[k];
      w[k] = ae[k] - along;
    }
    const volatile double w0 = w[0] * w[0], w1 = w[1] * w[1], w2 = w[2] * w[2];
    const volatile double w01 = w0 + w1, ww = w01 + w2;
    const double radius = std::nextafter(std::sqrt(ww), i % 2 == 0 ? 10.0 : 0.0);
    const bool expected = 0 < n && n < d && ww < radius * radius;
    CHECK(collides_inside({e[0], e[1], e[2]}, {a[0], a[1], a[2]}, {b[0], b[1], b[2]}, radius) ==
          expected);
    inside += expected;
  }
  CHECK(inside > 1000);
}
