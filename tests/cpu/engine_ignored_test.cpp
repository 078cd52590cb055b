// Every engine against brute force on points of which some are ignored: the answer is that of the
// others alone.
#include "random_scene.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

struct IgnoringScene : Scene {
  std::vector<std::uint8_t> classes = std::vector<std::uint8_t>(points.size());
  std::vector<std::uint8_t> ignore_classes;
  std::vector<Box> ignore_boxes;

  /// Checks every engine. Returns how many points collide and are not ignored.
  std::uint64_t check_ignoring() {
    classes.resize(points.size());
    QueryParameters parameters{radius};
    parameters.ignore_classes = ignore_classes;
    parameters.ignore_boxes = ignore_boxes;
    return check_engines(points, classes, quantisation, {model, poses, parameters});
  }
  std::uint64_t check_all() {
    ignore_classes.clear();
    ignore_boxes.clear();
    return check_ignoring();
  }
};

}  // namespace

TEST_CASE("ignored classes") {
  IgnoringScene scene;
  SECTION("of single points everywhere") {
    for (std::uint8_t& value : scene.classes) {
      value = static_cast<std::uint8_t>(below(scene.random, 7));
    }
    scene.ignore_classes = {2, 5};
  }
  SECTION("of wide ranges, in all widths of packed classes") {
    const unsigned width = GENERATE(1U, 2U, 4U, 5U, 7U, 8U);
    for (std::uint8_t& value : scene.classes) {
      value = static_cast<std::uint8_t>(below(scene.random, std::uint64_t{1} << width));
    }
    for (unsigned i = 0; i < 1U << width; i += 2) {
      scene.ignore_classes.push_back(static_cast<std::uint8_t>(i));
    }
  }
  SECTION("of whole regions") {
    for (std::size_t i = 0; i < scene.points.size(); ++i) {
      scene.classes[i] = scene.points[i][2] < 0 ? 2 : 1;
    }
    scene.ignore_classes = {2};
  }
  SECTION("of all but a few") {
    for (std::uint8_t& value : scene.classes) value = below(scene.random, 6) == 0 ? 6 : 255;
    scene.ignore_classes = {255};
  }
  const std::uint64_t left = scene.check_ignoring();
  CHECK(left > 0);
  CHECK(left < scene.check_all());
}

TEST_CASE("everything is ignored") {
  IgnoringScene scene;
  SECTION("by class") { scene.ignore_classes = {0}; }
  SECTION("by box") { scene.ignore_boxes = {{{-9, -9, -9}, {9, 9, 9}}}; }
  check_equal(scene.check_ignoring(), 0);
}

TEST_CASE("ignored boxes") {
  IgnoringScene scene;
  const auto around = [&](std::size_t pose, double reach) {
    const double* at = scene.poses[pose].translation;
    return Box{{at[0] - reach, at[1] - reach, at[2] - reach},
               {at[0] + reach, at[1] + reach, at[2] + reach}};
  };
  SECTION("one") { scene.ignore_boxes = {around(20, 1)}; }
  SECTION("two that overlap, and one that holds nothing") {
    scene.ignore_boxes = {around(10, 0.7), around(14, 0.8), {{7, 7, 7}, {8, 8, 8}}};
  }
  SECTION("with classes") {
    for (std::uint8_t& value : scene.classes) value = below(scene.random, 2) == 0 ? 3 : 9;
    scene.ignore_boxes = {around(20, 1)};
    scene.ignore_classes = {9};
  }
  const std::uint64_t left = scene.check_ignoring();
  CHECK(left > 0);
  CHECK(left < scene.check_all());
}

TEST_CASE("ignored points where floats cannot hold the lengths") {
  IgnoringScene scene;
  constexpr double kHuge = 1e15;
  for (double& scale : scene.quantisation.scale) scale *= kHuge;
  for (Vec3& m : scene.model) m = {m.x * kHuge, m.y * kHuge, m.z * kHuge};
  for (Pose& pose : scene.poses) {
    for (double& t : pose.translation) t *= kHuge;
  }
  scene.radius *= kHuge;
  scene.points.resize(700);
  scene.classes.resize(700);
  for (std::uint8_t& value : scene.classes) value = below(scene.random, 3) == 0 ? 1 : 2;
  scene.ignore_classes = {2};
  const std::uint64_t left = scene.check_ignoring();
  CHECK(left > 0);
  CHECK(left < scene.check_all());
}

TEST_CASE("a box holds the points on its sides") {
  IgnoringScene scene;
  const Vec3 at = transform(scene.poses[3], scene.model[2]);
  const Quantum q = quantise(std::vector{at}, scene.quantisation)[0];
  scene.points.assign(130, q);
  for (std::size_t i = 0; i < 3; ++i) scene.points.push_back({q[0] + 1, q[1], q[2]});
  const Vec3 corner = positions_of(std::vector{q}, scene.quantisation)[0];
  scene.ignore_boxes = {{corner, corner}};
  check_equal(scene.check_ignoring(), 3);
}

TEST_CASE("an ignored point is no pose's nearest one, however near it is") {
  IgnoringScene scene;
  scene.points.resize(200);
  const std::size_t others = scene.points.size();
  for (const Pose& pose : scene.poses) {  // whole blocks are ignored in the middle of the model
    for (int i = 0; i < 64; ++i) {
      scene.points.push_back(
          quantise(std::vector{transform(pose, Vec3{0, 0, 0})}, scene.quantisation)[0]);
    }
  }
  scene.classes.assign(others, 1);
  scene.classes.resize(scene.points.size(), 18);
  scene.ignore_classes = {18};
  scene.check_ignoring();
}
