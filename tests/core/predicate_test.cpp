#include "core/predicate.hpp"

#include <catch2/catch.hpp>
#include <cmath>

using namespace clearway;

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
  CHECK(rounded_sum(rounded_product(a, a), -rounded) == 0);
  const Pose pose{{x, x, 0, 0, 1, 0, 0, 0, 1}, {-rounded, 0, 0}};
  const Vec3 moved = transform(pose, {x, 0, 0});
  CHECK(moved.x == 0);
}
