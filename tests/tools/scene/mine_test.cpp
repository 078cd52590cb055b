#include <cmath>

#include "scene/vector.hpp"
#include "support/catch.hpp"
#include "tools/scene/made_scene.hpp"

using namespace clearway;
using namespace clearway::scene;

TEST_CASE("the mine is densest around its stations") {
  const Sizes sizes{200000, 1, 1};
  const auto mine = make_scene(Kind::kMine, sizes, 1);
  std::vector<Vec3> stations;
  for (const double s : mine->stations) stations.push_back(mine->path.to_world({s, 0, 1.5}));
  const auto nearest = [&](const Vec3& p) {
    double least = 1e30;
    for (const Vec3& station : stations) {
      least = std::min(least, std::hypot(p.x - station.x, p.y - station.y));
    }
    return least;
  };
  double near_metres = 0, far_metres = 0, near = 0, far = 0;
  for (double s = 0; s < mine->path.length(); s += 0.1) {
    const double distance = nearest(mine->path.at(s).position);
    (distance < 3 ? near_metres : far_metres) += 0.1;
  }
  for (const Vec3& p : test::las_positions(test::environment_bytes(*mine, 1, 2))) {
    (nearest(p) < 3 ? near : far) += 1;
  }
  REQUIRE(far_metres > 100);
  CHECK(near / near_metres > 2 * far / far_metres);
}

TEST_CASE("one station sees the rock around it, ever thinner with the range") {
  const std::uint64_t points = 440000;
  const auto mine = make_scene(Kind::kMine, {points, 1, 1}, 1);
  const auto positions = test::las_positions(test::environment_bytes(*mine, 1, 2));
  const Vec3 station = mine->path.to_world({mine->stations[0], 0, 1.5});
  int within[4] = {};  // number at distances of 0-5, 5-10, 10-15, 15-20 m
  for (std::size_t i = 0; i < points / mine->stations.size() - 2000; ++i) {
    const double range = length(positions[i] - station);
    CHECK(range > 0.5);
    if (range < 20) ++within[static_cast<int>(range / 5)];
  }
  CHECK(within[0] > 3 * within[1]);
  CHECK(within[1] > 3 * within[2]);
  CHECK(within[2] > within[3]);
  CHECK(within[3] > 0);
}

TEST_CASE("the loader goes once around the closed loop") {
  const auto mine = test::made_scene(Kind::kMine, {1, 5000, 1000});
  const auto at = [&](std::size_t i) {
    return Vec3{mine.poses[i].translation[0], mine.poses[i].translation[1],
                mine.poses[i].translation[2]};
  };
  const double step = length(at(1) - at(0));
  CHECK(length(at(999) - at(0)) == Approx(step).epsilon(0.05));
  double longest = 0;
  for (std::size_t i = 1; i < 1000; ++i) longest = std::max(longest, length(at(i) - at(i - 1)));
  CHECK(longest == Approx(step).epsilon(0.05));
  for (const Vec3& p : mine.model) {
    CHECK(std::abs(p.x) < 5);
    CHECK(std::abs(p.y) <= 1.3001);
    CHECK((p.z > -0.001 && p.z < 2.5));
  }
}
