// The predicate on a way, both ends included, against whole numbers.
#include <cmath>

#include "core/geometry/predicate.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/exact_way.hpp"
#include "support/scenes.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

WholePoint whole_point(Random& random, std::uint64_t size) {
  const auto coordinate = [&] {
    return static_cast<std::int64_t>(below(random, 2 * size + 1)) - static_cast<std::int64_t>(size);
  };
  return {coordinate(), coordinate(), coordinate()};
}

}  // namespace

TEST_CASE("a way touches what is nearer than the radius to its closed segment") {
  Random random(31);
  int touched = 0, at_an_end = 0, ties = 0, wrong = 0;
  for (int i = 0; i < 200'000; ++i) {
    const std::uint64_t size = 1 + below(random, 12);
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

TEST_CASE("a hit at the end of a way has begun on the way") {
  // It follows that a way with its end and one without it touch the same points.
  constexpr std::int64_t kParts = 1 << 20;
  Random random(32);
  int hits = 0, not_begun = 0;
  for (int i = 0; i < 100'000; ++i) {
    const WholePoint e = whole_point(random, 12), a = whole_point(random, 12),
                     b = whole_point(random, 12);
    const auto quarters = static_cast<std::int64_t>(1 + below(random, 60));
    const WholePoint at_end = e - b, way = b - a;
    if (16 * dot(at_end, at_end) >= quarters * quarters) continue;
    ++hits;
    // The place one of kParts parts of the way before its end, all lengths times kParts.
    const WholePoint before{kParts * at_end.x + way.x, kParts * at_end.y + way.y,
                            kParts * at_end.z + way.z};
    not_begun += 16 * dot(before, before) >= quarters * quarters * kParts * kParts;
  }
  CHECK(hits > 5'000);
  check_equal(not_begun, 0);
}

TEST_CASE("a hit at a pose is a hit on the ways to it and from it") {
  Random random(33);
  const Box box{{-1, -1, -1}, {1, 1, 1}};
  int hits = 0, lost = 0;
  for (int i = 0; i < 20'000; ++i) {
    const Vec3 e = random_point(random, box), a = random_point(random, box),
               b = random_point(random, box);
    // Radii at the very edge of what the pose decides.
    const double at = std::sqrt(squared_distance(e, a));
    for (const double radius : {std::nextafter(at, 0.0), at, std::nextafter(at, 2.0)}) {
      if (!collides(e, a, radius)) continue;
      ++hits;
      lost += !collides_on_way(e, a, b, radius) + !collides_on_way(e, b, a, radius);
    }
  }
  CHECK(hits > 20'000);
  check_equal(lost, 0);
}
