// Every engine against brute force: the shapes that a cloud, a model and a path can have.
#include "random_scene.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("a plain scene") {
  const Scene scene;
  const std::uint64_t colliding = scene.check();
  CHECK(colliding > 50);
  CHECK(colliding < scene.points.size());
}

TEST_CASE("an empty cloud, an empty model, an empty path") {
  Scene scene;
  SECTION("cloud") { scene.points.clear(); }
  SECTION("model") { scene.model.clear(); }
  SECTION("path") { scene.poses.clear(); }
  SECTION("all") {
    scene.points.clear();
    scene.model.clear();
    scene.poses.clear();
  }
  check_equal(scene.check(), 0);
}

TEST_CASE("one point, one model point, one pose") {
  Scene scene;
  SECTION("one environment point, touched") {
    const Vec3 at = transform(scene.poses[11], scene.model[5]);
    scene.points = quantise(std::vector{at}, scene.quantisation);
    check_equal(scene.check(), 1);
  }
  SECTION("one environment point, not touched") {
    scene.points = {{1'000'000, 0, 0}};
    check_equal(scene.check(), 0);
  }
  SECTION("one model point") {
    scene.model.resize(1);
    CHECK(scene.check() > 0);
  }
  SECTION("one pose") {
    scene.poses.resize(1);
    CHECK(scene.check() > 0);
  }
  SECTION("all one") {
    const Vec3 at = transform(scene.poses[0], scene.model[0]);
    scene.points = quantise(std::vector{at}, scene.quantisation);
    scene.model.resize(1);
    scene.poses.resize(1);
    check_equal(scene.check(), 1);
  }
}

TEST_CASE("numbers of points around those of blocks and cells") {
  for (const std::size_t count : {2, 63, 64, 65, 127, 128, 129, 191, 999, 1000, 1001, 2001}) {
    Scene scene;
    scene.points.resize(count);
    scene.radius = 0.3;
    CAPTURE(count);
    scene.check();
  }
}

TEST_CASE("duplicates") {
  Scene scene;
  SECTION("many points at one place, touched and not") {
    const Vec3 at = transform(scene.poses[3], scene.model[2]);
    const auto touched = quantise(std::vector{at}, scene.quantisation);
    scene.points.assign(1500, touched[0]);
    scene.points.resize(2500, {900'000, 0, 0});
    check_equal(scene.check(), 1500);
  }
  SECTION("every point three times") {
    const auto once = scene.points;
    scene.points.insert(scene.points.end(), once.begin(), once.end());
    scene.points.insert(scene.points.end(), once.begin(), once.end());
    check_equal(scene.check() % 3, 0);
  }
  SECTION("model points") {
    scene.model.resize(3);
    for (int i = 0; i < 100; ++i) scene.model.push_back(scene.model[0]);
    CHECK(scene.check() > 0);
  }
}

TEST_CASE("collinear and coplanar points") {
  Scene scene;
  const int flat = GENERATE(0, 1, 2);
  const double plane = scene.poses[20].translation[flat];
  for (Quantum& q : scene.points) q[flat] = static_cast<std::int32_t>(plane * 1e4);
  SECTION("an environment in a plane") { CHECK(scene.check() > 0); }
  SECTION("an environment on a line") {
    const int across = (flat + 1) % 3;
    const double line = scene.poses[20].translation[across];
    for (Quantum& q : scene.points) q[across] = static_cast<std::int32_t>(line * 1e4);
    CHECK(scene.check() > 0);
  }
  SECTION("a model in a plane") {
    for (Vec3& m : scene.model) m[flat] = 0.1;
    CHECK(scene.check() > 0);
  }
  SECTION("a model on a line") {
    for (Vec3& m : scene.model) m[flat] = m[(flat + 1) % 3] = 0.1;
    CHECK(scene.check() > 0);
  }
}

TEST_CASE("paths") {
  Scene scene;
  SECTION("repeated poses") {
    repeat_each(scene.poses, 5);
    CHECK(scene.check() > 0);
  }
  SECTION("there and back") {
    drive_back(scene.poses);
    CHECK(scene.check() > 0);
  }
  SECTION("jumps") {
    for (std::size_t i = 0; i < scene.poses.size(); i += 3) {
      scene.poses[i] = random_rotation(scene.random, random_point(scene.random, kRoom));
    }
    CHECK(scene.check() > 0);
  }
  SECTION("jumps far away and back") {
    for (std::size_t i = 1; i < scene.poses.size(); i += 2) {
      scene.poses[i].translation[0] += 1e7;
    }
    CHECK(scene.check() > 0);
  }
  SECTION("rotation on the spot") {
    scene.poses.clear();
    for (int i = 0; i < 100; ++i) {
      scene.poses.push_back(rotation({0, 0, 1}, 0.0628 * i, {0.5, 0.5, 0.3}));
    }
    scene.model.resize(20);
    CHECK(scene.check() > 0);
  }
  SECTION("six printed digits") {
    print_with_six_digits(scene.poses);
    CHECK(scene.check() > 0);
  }
}

TEST_CASE("matrices that are not rigid") {
  Scene scene;
  scene.points.resize(1200);
  SECTION("slightly") { stretch(scene.poses, {1.00009, 0.99992, 1.00005}); }
  SECTION("strongly") { stretch(scene.poses, {2.5, 0.3, 1.7}); }
  SECTION("mirrored") { stretch(scene.poses, {-1, 1, 1}); }
  SECTION("singular") { stretch(scene.poses, {3, 0, 1}); }
  SECTION("sheared") {
    for (Pose& pose : scene.poses) {
      for (int row = 0; row < 3; ++row) pose.rotation[3 * row] += 1.5 * pose.rotation[3 * row + 1];
    }
  }
  CHECK(scene.check() > 0);
}

TEST_CASE("touched points on the borders of cells and blocks") {
  // A lattice: many points lie on the planes that split it, and the path runs along one.
  Scene scene;
  scene.points.clear();
  for (std::int32_t i = 0; i < 4096; ++i) {
    scene.points.push_back({i % 16 * 1000, i / 16 % 16 * 1000, i / 256 * 1000});
  }
  scene.model = {{0, 0, 0}, {0.05, 0, 0}, {0, 0.1, 0}};
  scene.poses.clear();
  for (int i = 0; i < 40; ++i) scene.poses.push_back(translation({0.04 * i, 0.75, 0.7}));
  for (const double radius : {0.05, 0.1, 0.15}) {
    scene.radius = radius;
    CHECK(scene.check() > 0);
  }
}

TEST_CASE("a cell far wider than the radius") {
  // Boxes of blocks are stored in steps of 3 mm here; the model touches one point at a time.
  Scene scene;
  scene.points = quantise(random_points(scene.random, {{-100, -100, -100}, {100, 100, 100}}, 2000),
                          scene.quantisation);
  scene.model = {{0, 0, 0}, {0.1, 0, 0}};
  scene.poses.clear();
  for (std::size_t i = 0; i < 600; ++i) {
    const Quantum& q = scene.points[i];
    scene.poses.push_back(translation(position(scene.quantisation, q[0], q[1], q[2])));
  }
  scene.radius = 1e-4;
  check_equal(scene.check(), 600);
}

TEST_CASE("a model of a few points far apart") {
  Scene scene;
  scene.model = random_points(scene.random, kRoom, 12);
  scene.radius = 0.1;
  CHECK(scene.check() > 0);
}
