// The predicate on a way, both ends included, against whole numbers.
#include <cmath>

#include "core/geometry/predicate.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/exact_way.hpp"
#include "support/scenes.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("a way touches what is nearer than the radius to its closed segment") {
  Random random(31);
  int touched = 0, at_an_end = 0, ties = 0, wrong = 0;
  for (int i = 0; i < 200'000; ++i) {
    const auto size = static_cast<std::int64_t>(1 + below(random, 12));
    const WholePoint e = whole_point(random, size), a = whole_point(random, size),
                     b = whole_point(random, size);
    const auto quarters = static_cast<std::int64_t>(1 + below(random, 40));
    const ExactWay way(e, a, b);
    if (way.is_rounded_tie(quarters)) {
      ++ties;
      continue;
    }
    wrong += collides_on_way(e.as_double(), a.as_double(), b.as_double(),
                             static_cast<double>(quarters) / 4) != way.is_within(quarters);
    touched += way.is_within(quarters);
    at_an_end += way.is_within(quarters) && way.under == 1;
  }
  check_equal(wrong, 0);
  CHECK(touched > 20'000);
  CHECK(at_an_end > 5'000);
  CHECK(ties < 2'000);
}

TEST_CASE("a hit at a pose is a hit on the ways to it and from it") {
  Random random(33);
  const Box box{{-1, -1, -1}, {1, 1, 1}};
  int hits = 0, lost = 0;
  for (int i = 0; i < 20'000; ++i) {
    const std::vector<Vec3> p = random_points(random, box, 3);
    // Radii at the very edge of what the pose decides.
    const double at = std::sqrt(squared_distance(p[0], p[1]));
    for (const double radius : {std::nextafter(at, 0.0), at, std::nextafter(at, 2.0)}) {
      if (!collides(p[0], p[1], radius)) continue;
      ++hits;
      lost +=
          !collides_on_way(p[0], p[1], p[2], radius) + !collides_on_way(p[0], p[2], p[1], radius);
    }
  }
  CHECK(hits > 20'000);
  check_equal(lost, 0);
}
