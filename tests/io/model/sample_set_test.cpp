#include "io/model/sample_set.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <random>
#include <vector>

#include "core/geometry/predicate.hpp"

using namespace clearway;

TEST_CASE("what is gathered about a box is all that can be near one of its places") {
  constexpr double kReach = 0.5;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> anywhere(-4, 4), side(0, 1.5), share(0, 1);
  SampleSet samples(kReach);
  for (int i = 0; i < 3000; ++i)
    samples.add({anywhere(random), anywhere(random), anywhere(random)});
  std::vector<Vec3> near;
  for (int i = 0; i < 200; ++i) {
    const Vec3 lo{anywhere(random), anywhere(random), anywhere(random)};
    const Box box{lo, {lo.x + side(random), lo.y + side(random), lo.z + side(random)}};
    REQUIRE(samples.gather(box, near));
    const Vec3 place{lo.x + share(random) * (box.hi.x - lo.x),
                     lo.y + share(random) * (box.hi.y - lo.y),
                     lo.z + share(random) * (box.hi.z - lo.z)};
    std::size_t expected = 0, found = 0;
    for (const Vec3& p : samples.points()) {
      if (squared_distance(p, place) > kReach * kReach) continue;
      ++expected;
      found += std::find(near.begin(), near.end(), p) != near.end() ? 1 : 0;
    }
    CHECK(found == expected);
  }
  CHECK(near.size() < samples.size() / 4);
}

TEST_CASE("crowded places are not gathered") {
  SampleSet samples(1);
  for (int i = 0; i < 1024; ++i) samples.add({0.5, 0.5, 0.5 + i * 1e-6});
  std::vector<Vec3> near;
  CHECK_FALSE(samples.gather({{0, 0, 0}, {0.1, 0.1, 0.1}}, near));
  CHECK(samples.gather({{9, 9, 9}, {9.5, 9.5, 9.5}}, near));
  CHECK(near.empty());
}
