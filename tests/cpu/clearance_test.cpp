// Clearances against brute force, where they are hard: ties, clearances of any size, roundings.
#include <cmath>

#include "core/geometry/predicate.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/engines/scene_checks.hpp"
#include "support/scenes.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

const Quantisation kTenthMillimetre{{1e-4, 1e-4, 1e-4}, {0, 0, 0}};
const Box kRoomOfClearances{{-4, -3, -1}, {5, 4, 2}};
const Box kPartOfClearances{{-0.6, -0.4, -0.3}, {0.7, 0.5, 0.2}};

struct SceneOfClearances : SceneChecks<SceneOfClearances> {
  Random random{17};
  Quantisation quantisation = kTenthMillimetre;
  std::vector<Quantum> points =
      quantise(random_points(random, kRoomOfClearances, 1000), quantisation);
  std::vector<Vec3> model = random_points(random, kPartOfClearances, 60);
  std::vector<Pose> poses = smooth_path(random, kRoomOfClearances, 60);
  double radius = 0.1;

  Query query() const { return {model, poses, {radius}}; }
};

}  // namespace

TEST_CASE("clearances of every size") {
  SceneOfClearances scene;
  SECTION("smaller than every distance") { check_equal(scene.check_clearance(1e-7), 0); }
  SECTION("smaller than the radius") { CHECK(scene.check_clearance(0.07) > 0); }
  SECTION("the radius") { CHECK(scene.check_clearance(0.1) > 0); }
  SECTION("just above it") { CHECK(scene.check_clearance(std::nextafter(0.1, 1)) > 0); }
  SECTION("far larger") { CHECK(scene.check_clearance(2) > 300); }
  SECTION("larger than the scene") { CHECK(scene.check_clearance(1000) == scene.points.size()); }
  SECTION("beyond any scene") { CHECK(scene.check_clearance(1e150) == scene.points.size()); }
  SECTION("whose square is infinite") {
    CHECK(scene.check_clearance(1e200) == scene.points.size());
  }
  SECTION("whose square is zero") { check_equal(scene.check_clearance(1e-200), 0); }
  SECTION("with a radius far below the model's spacing") {
    scene.radius = 1e-4;
    CHECK(scene.check_clearance(1.5) > 200);
  }
  SECTION("with a radius larger than the scene") {
    scene.radius = 30;
    CHECK(scene.check_clearance(0.5) > 0);
  }
}

TEST_CASE("clearances of few model points, poses and points") {
  SceneOfClearances scene;
  SECTION("one model point") { scene.model.resize(1); }
  SECTION("one pose") { scene.poses.resize(1); }
  SECTION("one point") { scene.points.resize(1); }
  SECTION("one of each") {
    scene.model.resize(1);
    scene.poses.resize(1);
    scene.points.resize(1);
  }
  CHECK(scene.check_clearance(20) == scene.points.size());
}

TEST_CASE("clearances along slow paths") {
  // Seen from the model, runs of many poses are nearly straight, so they are searched as one.
  SceneOfClearances scene;
  scene.points.resize(250);
  const double bend = GENERATE(0.0, 1e-9, 1e-3, 0.5, 4.0);
  scene.poses = slow_path(500, bend);
  SECTION("as they are") {}
  SECTION("with a stop") { stop_at(scene.poses, 200, 300); }
  SECTION("to and fro") { drive_back(scene.poses); }
  SECTION("with a jump") { scene.poses.insert(scene.poses.begin() + 77, scene.poses.back()); }
  SECTION("jittering") {
    for (Pose& pose : scene.poses) pose.translation[1] += 1e-3 * random_direction(scene.random).y;
  }
  SECTION("stretched") { stretch(scene.poses, {1.2, 0.8, 1.00005}); }
  SECTION("far away") { scene.move_far_away({5e6, 2e6, 1e3}); }
  CHECK(scene.check_clearance(0.4) > 10);
}

TEST_CASE("clearances that several poses tie for") {
  SceneOfClearances scene;
  SECTION("repeated poses") { repeat_each(scene.poses, 4); }
  SECTION("one pose all the time") { scene.poses.assign(50, scene.poses[7]); }
  SECTION("there and back and there again") {
    const auto there = scene.poses;
    drive_back(scene.poses);
    scene.poses.insert(scene.poses.end(), there.begin(), there.end());
  }
  SECTION("later poses first in the tree's order") {
    scene.poses.insert(scene.poses.begin(), scene.poses.rbegin(), scene.poses.rend());
  }
  CHECK(scene.check_clearance(3) > 300);
}

TEST_CASE("clearances that mirror images tie for") {
  // Points in the plane x = 0 and poses at -x and x, all in exact numbers: d2 is equal and the
  // earlier pose wins.
  SceneOfClearances scene;
  scene.quantisation = {{0x1p-10, 0x1p-10, 0x1p-10}, {0, 0, 0}};
  scene.points.clear();
  for (std::int32_t i = 0; i < 900; ++i) scene.points.push_back({0, i % 30 * 64, i / 30 * 32});
  scene.model = {{0, 0, 0}, {0, 0.25, 0}, {0, 0, 0.5}};
  scene.poses.clear();
  const bool towards = GENERATE(false, true);
  for (int i = -32; i <= 32; ++i) {
    if (i != 0) scene.poses.push_back(translation({(towards ? i : -i) * 0x1p-5, 0.5, 0.25}));
  }
  CHECK(scene.check_clearance(4) == scene.points.size());
  scene.model = {{0.5, 0, 0}, {-0.5, 0, 0}};  // ties between model points, too
  CHECK(scene.check_clearance(4) == scene.points.size());
}

TEST_CASE("clearances of duplicates") {
  SceneOfClearances scene;
  scene.points.resize(300);
  for (int i = 0; i < 300; ++i) scene.points.push_back(scene.points[i]);
  for (int i = 0; i < 60; ++i) scene.model.push_back(scene.model[i]);
  check_equal(scene.check_clearance(1) % 2, 0);
}

TEST_CASE("clearances far from the origin and of matrices that are not rigid") {
  SceneOfClearances scene;
  SECTION("UTM") { scene.move_far_away({5e6, 2e6, 1e3}); }
  SECTION("six digits") { print_with_six_digits(scene.poses); }
  SECTION("slightly stretched") { stretch(scene.poses, {1.00009, 0.99992, 1.00005}); }
  SECTION("strongly stretched") { stretch(scene.poses, {2.5, 0.3, 1.7}); }
  SECTION("strongly stretched, far away") {
    stretch(scene.poses, {0.2, 1.4, 0.7});
    scene.move_far_away({5e6, 2e6, 1e3});
  }
  SECTION("singular") { stretch(scene.poses, {3, 0, 1}); }
  CHECK(scene.check_clearance(1.5) > 100);
}

TEST_CASE("clearances where roundings decide the pose and the model point") {
  // All points of the model are equally far from the points asked about, but for a few roundings,
  // at poses that differ by as little: the least computed d2 is not that of the nearest point.
  Random random(23);
  for (int trial = 0; trial < 40; ++trial) {
    const double far = trial % 3 == 0 ? 0 : trial % 3 == 1 ? 1e3 : 5e6;
    const double ulp = std::max(far, 1.0) * 0x1p-52;
    const Vec3 centre{far, -0.7 * far, 0.3 * far};
    SceneOfClearances scene;
    scene.model.clear();
    for (int i = 0; i < 40; ++i) {
      const Vec3 d = random_direction(random);
      scene.model.push_back({0.5 * d.x, 0.5 * d.y, 0.5 * d.z});
    }
    scene.poses.clear();
    for (int i = 0; i < 30; ++i) {
      const Vec3 by = random_direction(random);
      scene.poses.push_back(random_rotation(
          random,
          {centre.x + 4 * ulp * by.x, centre.y + 4 * ulp * by.y, centre.z + 4 * ulp * by.z}));
    }
    for (int k = 0; k < 3; ++k) {
      scene.quantisation.scale[k] = ulp;
      scene.quantisation.offset[k] = centre[k];
    }
    scene.points.clear();
    for (int i = 0; i < 40; ++i) {
      Quantum q;
      for (int k = 0; k < 3; ++k) q[k] = static_cast<std::int32_t>(below(random, 5)) - 2;
      scene.points.push_back(q);
    }
    check_equal(scene.check_clearance(0.9), 40);
  }
}
