#include "core/geometry/predicate.hpp"

#include <cmath>

#include "support/compare.hpp"
#include "support/predicate_cases.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("the predicate decides as it is spelt out, also where a kernel runs it") {
  const auto cases = cases_at_the_radius(100'000);
  std::vector<PredicateAnswer> answers;
  for (const PredicateCase& c : cases) answers.push_back(decide(c));
  check_decided(cases, answers);
}

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
  check_equal(transform(pose, {x, 0, 0}).x, 0);
}

TEST_CASE("the inside of a segment is strict at the radius and at both ends") {
  struct Row {
    Vec3 e, b;
    double radius;
    bool inside;
  };
  const Vec3 ahead{1, 0, 0};
  const Row rows[] = {
      {{0.5, 0.25, 0}, ahead, std::nextafter(0.25, 1), true},
      {{0.5, 0.25, 0}, ahead, 0.25, false},
      {{0, 0.1, 0}, ahead, 0.25, false},
      {{1, 0.1, 0}, ahead, 0.25, false},
      {{-0.1, 0, 0}, ahead, 0.25, false},
      {{1.1, 0, 0}, ahead, 0.25, false},
      {{0x1p-60, 0.1, 0}, ahead, 0.25, true},
      {{std::nextafter(1.0, 0), 0.1, 0}, ahead, 0.25, true},
      // Segments without a length, or with one whose numbers under- or overflow
      {{0.1, 0, 0}, {0, 0, 0}, 1, false},
      {{0.1, 0, 0}, {1e-170, 0, 0}, 1, false},
      {{0.1, 0, 0}, {1e200, 0, 0}, 0.01, false},
      {{1e200, 0, 0}, {1e200, 1, 0}, 1, false},
  };
  for (const Row& row : rows) {
    CAPTURE(row.e.x, row.e.y, row.b.x, row.radius);
    CHECK(collides_inside(row.e, {0, 0, 0}, row.b, row.radius) == row.inside);
  }
}
