// Every engine against brute force: radii, coordinates and matrices at their ends.
#include <cstdint>
#include <limits>

#include "random_scene.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("matrices that make a model of any size as large as the scene") {
  Scene scene;
  scene.points.resize(800);  // few, because bounds tell nothing here and every pair is tested
  scene.poses.resize(15);
  const double size = GENERATE(1e-104, 1e-18, 1e104);
  for (Vec3& m : scene.model) {
    for (int k = 0; k < 3; ++k) m[k] *= size;
  }
  stretch(scene.poses, {1 / size, 1 / size, 1 / size});
  CHECK(scene.check() > 0);
}

TEST_CASE("radii") {
  Scene scene;
  SECTION("larger than the scene") {
    scene.radius = 50;
    CHECK(scene.check() == scene.points.size());
  }
  SECTION("about as large as the scene") {
    scene.radius = 3;
    scene.poses.resize(2);
    scene.model.resize(3);
    CHECK(scene.check() > 0);
  }
  SECTION("whose square is infinite") {
    scene.radius = 1e200;
    CHECK(scene.check() == scene.points.size());
  }
  SECTION("whose square is zero") {
    scene.points.clear();
    for (const Vec3& m : scene.model)
      scene.points.push_back(quantise(std::vector{m}, scene.quantisation)[0]);
    scene.model = positions_of(scene.points, scene.quantisation);
    scene.poses = {translation({0, 0, 0})};
    scene.radius = 1e-170;
    check_equal(scene.check(), 0);
    scene.radius = 1e-155;  // here the computed distances are zero, so below the radius
    CHECK(scene.check() == scene.points.size());
  }
  SECTION("of a few quanta") {
    scene.radius = 4e-4;
    const Vec3 at = transform(scene.poses[4], scene.model[7]);
    for (int i = 0; i < 500; ++i) {
      const Box around{{at.x - 6e-4, at.y - 6e-4, at.z - 6e-4},
                       {at.x + 6e-4, at.y + 6e-4, at.z + 6e-4}};
      scene.points.push_back(
          quantise(std::vector{random_point(scene.random, around)}, scene.quantisation)[0]);
    }
    CHECK(scene.check() > 10);
  }
}

TEST_CASE("coordinates far from the origin") {
  Scene scene;
  Vec3 offset{};
  SECTION("negative") { offset = {-1000, -2000, -300}; }
  SECTION("UTM") { offset = {5e6, 2e6, 1e3}; }
  for (int k = 0; k < 3; ++k) scene.quantisation.offset[k] = offset[k];
  for (Pose& pose : scene.poses) {
    for (int k = 0; k < 3; ++k) pose.translation[k] += offset[k];
  }
  CHECK(scene.check() > 50);
}

TEST_CASE("a model far from its own origin") {
  Scene scene;
  for (Vec3& m : scene.model) m = {m.x + 3e6, m.y - 2e6, m.z};
  for (Pose& pose : scene.poses) {
    const Vec3 origin = transform(pose, {3e6, -2e6, 0});
    for (int k = 0; k < 3; ++k) pose.translation[k] += pose.translation[k] - origin[k];
  }
  CHECK(scene.check() > 50);
}

TEST_CASE("coordinates near the ends of double") {
  Scene scene;
  scene.points.resize(1000);  // few, as above
  SECTION("poses") {
    scene.poses[3].translation[0] = 1e308;
    scene.poses[5].rotation[4] = 1e300;
    scene.poses[7].rotation[0] = scene.poses[7].rotation[1] = 1e308;
  }
  SECTION("model") {
    scene.model[3].x = 1e308;
    scene.model[4].y = -1e308;
  }
  CHECK(scene.check() > 0);
}

TEST_CASE("quanta at the ends of int32") {
  Scene scene;
  scene.quantisation = {{1e-9, 2e-9, 1.5e-9}, {1, 2, 3}};
  const std::int32_t lo = std::numeric_limits<std::int32_t>::min();
  const std::int32_t hi = std::numeric_limits<std::int32_t>::max();
  scene.points.clear();
  for (int i = 0; i < 500; ++i) {
    Quantum q;
    for (int k = 0; k < 3; ++k) {
      q[k] = static_cast<std::int32_t>(std::int64_t{lo} +
                                       static_cast<std::int64_t>(below(scene.random, 1ull << 32)));
      if (below(scene.random, 3) == 0) q[k] = below(scene.random, 2) == 0 ? lo : hi;
    }
    scene.points.push_back(q);
  }
  scene.model.resize(10);
  for (Pose& pose : scene.poses) {
    for (int k = 0; k < 3; ++k) pose.translation[k] = k + 1 + 0.3 * pose.translation[k];
  }
  scene.radius = 0.7;
  CHECK(scene.check() > 0);
}
