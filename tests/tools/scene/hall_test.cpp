#include <cmath>

#include "support/catch.hpp"
#include "tools/scene/made_scene.hpp"

using namespace clearway;
using namespace clearway::scene;

namespace {

double distance_to_poses(const std::vector<Pose>& poses, const Vec3& p) {
  double least = 1e30;
  for (const Pose& pose : poses) {
    const double dx = p.x - pose.translation[0], dy = p.y - pose.translation[1];
    least = std::min(least, dx * dx + dy * dy);
  }
  return std::sqrt(least);
}

struct Extent {
  Vec3 low{1e30, 1e30, 1e30}, high{-1e30, -1e30, -1e30};
};

Extent extent_of(const std::vector<Vec3>& points) {
  Extent out;
  for (const Vec3& p : points) {
    for (int k = 0; k < 3; ++k) {
      out.low[k] = std::min(out.low[k], p[k]);
      out.high[k] = std::max(out.high[k], p[k]);
    }
  }
  return out;
}

}  // namespace

TEST_CASE("the floor of the hall and the plant is scanned densest beside the path") {
  for (const Kind kind : {Kind::kHall, Kind::kPlant}) {
    const auto made = test::made_scene(kind, {60000, 10, 400});
    double near = 0, far = 0;
    for (const Vec3& p : made.environment) {
      if (std::abs(p.z) > 0.02) continue;
      const double distance = distance_to_poses(made.poses, p);
      if (distance > 1 && distance < 3) near += 1;
      if (distance > 6 && distance < 8) far += 1;
    }
    CHECK(far > 100);
    CHECK(near > 4 * far);
  }
}

TEST_CASE("the hall is as long at any density") {
  const Extent sparse = extent_of(test::made_scene(Kind::kHall, {20000, 1, 1}).environment);
  const Extent dense = extent_of(test::made_scene(Kind::kHall, {400000, 1, 1}).environment);
  for (int k = 0; k < 3; ++k) {
    CHECK(sparse.low[k] == Approx(dense.low[k]).margin(3));
    CHECK(sparse.high[k] == Approx(dense.high[k]).margin(3));
  }
  CHECK(dense.high.x - dense.low.x > 90);
  CHECK(dense.high.z - dense.low.z == Approx(7).margin(0.1));
}

TEST_CASE("points come in the order of time: neighbours in the file are neighbours in the hall") {
  const auto made = test::made_scene(Kind::kHall, {100000, 1, 1});
  std::size_t jumps = 0;
  for (std::size_t i = 1; i < made.environment.size(); ++i) {
    if (squared_distance(made.environment[i], made.environment[i - 1]) > 4) ++jumps;
  }
  CHECK(jumps < made.environment.size() / 5);
}

TEST_CASE("the car bodies have a car's size and are hollow") {
  for (const Kind kind : {Kind::kHall, Kind::kPlant}) {
    const auto model = test::made_scene(kind, {1, 20000, 1}).model;
    const Extent extent = extent_of(model);
    const double length = kind == Kind::kHall ? 4.5 : 4.9;
    CHECK(extent.high.x - extent.low.x == Approx(length).margin(0.1));
    CHECK(extent.high.y - extent.low.y == Approx(kind == Kind::kHall ? 1.9 : 2.0).margin(0.1));
    CHECK(extent.high.z - extent.low.z == Approx(kind == Kind::kHall ? 1.5 : 1.75).margin(0.1));
    for (const Vec3& p : model) {  // the passenger compartment
      CHECK_FALSE((std::abs(p.x + 0.3) < 0.4 && std::abs(p.y) < 0.5 && p.z > 0.4 && p.z < 1.2));
    }
  }
}

TEST_CASE("the plant's path is sampled every two millimetres at its full size") {
  const auto made = make_scene(Kind::kPlant, full_sizes(Kind::kPlant), 1);
  const Pose a = made->pose(200000), b = made->pose(200001);
  const Vec3 none{0, 0, 0};
  CHECK(std::sqrt(squared_distance(transform(a, none), transform(b, none))) ==
        Approx(0.002).margin(0.0003));
}
