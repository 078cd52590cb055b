// Every engine against brute force: the shapes that a cloud, a model and a path can have.
#include <cmath>

#include "engine_scenes.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("scenes that are hard for every kind of model") {
  PlainScene scene(GENERATE(Kind::kPoints, Kind::kSurface, Kind::kSolids));
  std::vector<Pose>& poses = scene.query.poses;
  scene.points.resize(300);
  double reach = 1.5;
  SECTION("one pose") { poses.resize(1); }
  SECTION("one point") {
    scene.points.resize(1);
    reach = 20;
  }
  SECTION("one pose all the time") { poses.assign(50, poses[7]); }
  SECTION("there and back and there again") {
    const auto there = poses;
    drive_back(poses);
    poses.insert(poses.end(), there.begin(), there.end());
  }
  SECTION("steps that double: a tree deeper than its levels") {
    poses.clear();
    for (int i = -40; i < 3; ++i) poses.push_back(translation({std::ldexp(1, i), 0, 0}));
  }
  SECTION("mirrored, far away") {
    stretch(poses, {-1, 1, 1});
    scene.move_far_away({5e6, -2e6, 1e3});
  }
  SECTION("flattened") { stretch(poses, {3, 0, 1}); }
  SECTION("a model far from its own origin") {
    for (Vec3& m : scene.query.model.vertices) m = plus(m, 1, {3e6, -2e6, 0});
    for (Pose& pose : poses) {
      const Vec3 off = difference(transform(pose, {3e6, -2e6, 0}), pose.position());
      for (int k = 0; k < 3; ++k) pose.translation[k] -= off[k];
    }
  }
  SECTION("all points twice") {
    const auto once = scene.points;
    scene.points.insert(scene.points.end(), once.begin(), once.end());
  }
  SECTION("a radius below all sizes") { scene.query.radius = 1e-4; }
  SECTION("a radius as large as the scene, and one larger than it") {
    scene.query.radius = GENERATE(3.0, 30.0);
    poses.resize(3);
    scene.points.resize(150);
  }
  CHECK(check_engines(scene, {.reach = reach}).nearest()[0].squared < 1e3 * 1e3);
}

TEST_CASE("an empty cloud, an empty model, an empty path") {
  PlainScene scene;
  const std::string without = GENERATE("cloud", "model", "path", "all");
  if (without == "cloud" || without == "all") scene.points.clear();
  if (without == "model" || without == "all") scene.query.model = {};
  if (without == "path" || without == "all") scene.query.poses.clear();
  check_equal(check_engines(scene).colliding(), 0);
}

TEST_CASE("clouds of points of every shape") {
  PlainScene scene;
  const Vec3 touched = transform(scene.query.poses[3], scene.query.model.vertices[2]);
  SECTION("a plain one") { CHECK(check_engines(scene).colliding() > 50); }
  SECTION("one touched point") {
    scene.set_points({touched});
    check_equal(check_engines(scene).colliding(), 1);
  }
  SECTION("numbers of points around those of blocks and cells") {
    for (const std::size_t count : {2, 63, 64, 65, 127, 128, 129, 191, 999, 1000, 1001, 2001}) {
      CAPTURE(count);
      scene.points.resize(count, scene.points[0]);
      check_engines(scene);
    }
  }
  SECTION("many points at one place, touched and not") {
    scene.set_points(std::vector<Vec3>(1500, touched));
    scene.points.resize(2500, {900'000, 0, 0});
    check_equal(check_engines(scene).colliding(), 1500);
  }
  SECTION("a cell of more blocks than a warp searches at once") {
    scene.set_points(random_points(scene.random, kRoom, 100'000));
    scene.query.model.vertices.resize(5);
    scene.query.poses.resize(4);
    CHECK(check_engines(scene, {.reach = 0.5, .packings = {{}}}).colliding() > 0);
  }
  SECTION("a cell far wider than the radius, of which the model touches one point at a time") {
    // Boxes of blocks are stored in steps of 3 mm here.
    scene.set_points(random_points(scene.random, {{-100, -100, -100}, {100, 100, 100}}, 2000));
    scene.query.model = {{0, 0, 0}, {0.1, 0, 0}};
    scene.query.poses.clear();
    const std::vector<Vec3> places = positions_of(scene.points, scene.quantisation);
    for (std::size_t i = 0; i < 600; ++i) scene.query.poses.push_back(translation(places[i]));
    scene.query.radius = 1e-4;
    check_equal(check_engines(scene).colliding(), 600);
  }
}

TEST_CASE("touched points on the borders of cells and blocks") {
  // A lattice: many points lie on the planes that split it, and the path runs along one.
  PlainScene scene;
  scene.points.clear();
  for (std::int32_t i = 0; i < 4096; ++i) {
    scene.points.push_back({i % 16 * 1000, i / 16 % 16 * 1000, i / 256 * 1000});
  }
  scene.query.model = {{0, 0, 0}, {0.05, 0, 0}, {0, 0.1, 0}};
  scene.query.poses.clear();
  for (int i = 0; i < 40; ++i) scene.query.poses.push_back(translation({0.04 * i, 0.75, 0.7}));
  scene.query.radius = GENERATE(0.05, 0.1, 0.15);
  CHECK(check_engines(scene).colliding() > 0);
}

TEST_CASE("lengths at the ends of what numbers hold") {
  PlainScene scene;
  scene.points.resize(400);  // few, because bounds tell nothing here and every pair is tested
  scene.query.poses.resize(15);
  double reach = 0;
  SECTION("a radius whose square is infinite") { scene.query.radius = 1e200; }
  SECTION("a radius whose square is zero, and one for which distances are zero") {
    scene.set_points(scene.query.model.vertices);
    scene.query.model = positions_of(scene.points, scene.quantisation);
    scene.query.poses = {translation({0, 0, 0})};
    scene.query.radius = 1e-170;
    check_equal(check_engines(scene).colliding(), 0);
    scene.query.radius = 1e-155;
  }
  SECTION("a radius of a few quanta") {
    scene.query.radius = 4e-4;
    const Vec3 at = transform(scene.query.poses[4], scene.query.model.vertices[7]);
    for (const Vec3& by : random_points(scene.random, {{-6, -6, -6}, {6, 6, 6}}, 500)) {
      scene.add_point(plus(at, 1e-4, by));
    }
  }
  SECTION("a reach of any size") { reach = GENERATE(1e-200, 1e-7, 1e3, 1e150, 1e200); }
  SECTION("a model of any size that matrices make as large as the scene") {
    const double size = GENERATE(1e-104, 1e-18, 1e104);
    for (Vec3& m : scene.query.model.vertices) m = plus({}, size, m);
    stretch(scene.query.poses, {1 / size, 1 / size, 1 / size});
  }
  SECTION("poses near the ends of double") {
    scene.query.poses[3].translation[0] = 1e308;
    scene.query.poses[5].rotation[4] = 1e300;
    scene.query.poses[7].rotation[0] = scene.query.poses[7].rotation[1] = 1e308;
  }
  SECTION("model points near the ends of double") {
    scene.query.model.vertices[3].x = 1e308;
    scene.query.model.vertices[4].y = -1e308;
  }
  SECTION("lengths that floats cannot hold") { scale_up(scene, 1e15); }
  SECTION("quanta at the ends of int32") {
    scene.quantisation = {{1e-9, 2e-9, 1.5e-9}, {1, 2, 3}};
    for (Quantum& q : scene.points) {
      for (std::int32_t& value : q) {
        constexpr std::int32_t kEnds[] = {std::numeric_limits<std::int32_t>::min(),
                                          std::numeric_limits<std::int32_t>::max()};
        value = below(scene.random, 3) == 0 ? kEnds[below(scene.random, 2)]
                                            : static_cast<std::int32_t>(scene.random());
      }
    }
    for (Pose& pose : scene.query.poses) {
      for (int k = 0; k < 3; ++k) pose.translation[k] = k + 1 + 0.3 * pose.translation[k];
    }
    scene.query.radius = 0.7;
  }
  CHECK(check_engines(scene, {.reach = reach}).colliding() > 0);
}

TEST_CASE("surfaces and solids of few triangles") {
  PlainScene scene(Kind::kSurface);
  scene.points.resize(200);
  Model& model = scene.query.model;
  const Surface box = box_surface(kPart);
  SECTION("a box") { model = surface_model(box); }
  SECTION("a triangle that is an edge") { model.triangles = {{2, 3, 2}}; }
  SECTION("the same one many times") { model.triangles.assign(30, model.triangles[0]); }
  SECTION("lines and single points, as meshes draw them") {
    model.triangles.clear();
    for (std::uint32_t i = 1; i < 40; ++i) model.triangles.push_back({i, i + 1, i + 1});
    for (std::uint32_t i = 40; i < 60; ++i) model.triangles.push_back({i, i, i});
  }
  SECTION("a line and two points of a box") {
    model = surface_model(box);
    model.triangles = {{0, 7, 7}, {1, 1, 1}, {4, 4, 4}};
  }
  SECTION("a solid with a cavity") {
    Bodies bodies;
    bodies.add(box);
    bodies.add(turned_inwards(box_surface({{-0.3, -0.2, -0.2}, {0.5, 0.4, 0.1}})));
    model = solid_model(bodies);
  }
  SECTION("parts that are all open") {
    model = surface_model(box);
    model.solid_of.assign(12, kNoSolid);
  }
  SECTION("a solid in whose middle hundreds of metres are free of triangles") {
    model = solid_model(box_surface({{-100, -100, -100}, {100, 100, 100}}));
    scene.query.poses = {translation({0, 0, 0}), translation({300, 0, 0})};
    scene.query.radius = 1e-3;
    scene.quantisation = quantisation_of(1);
    scene.points = {{0, 0, 0}, {99, 99, 99}, {101, 0, 0}, {201, 0, 0}, {250, 1, 2}};
    check_equal(Expected(scene).colliding(), 4);
  }
  CHECK(check_engines(scene, {.reach = 1.5}).clearances()[0].found());
}

TEST_CASE("ignored points") {
  PlainScene scene;
  scene.points.resize(400);
  std::vector<std::uint8_t>& ignored = scene.query.ignore_classes;
  SECTION("of every second class, in all widths of packed classes") {
    const unsigned width = GENERATE(1U, 2U, 3U, 4U, 5U, 7U, 8U);
    for (int i = 0; i < 400; ++i) {
      scene.classes.push_back(static_cast<std::uint8_t>(scene.random() % (1U << width)));
    }
    for (unsigned i = 0; i < 1U << width; i += 2) ignored.push_back(static_cast<std::uint8_t>(i));
  }
  SECTION("of whole regions") {
    for (const Quantum& q : scene.points) scene.classes.push_back(q[2] < 0 ? 2 : 1);
    ignored = {2};
  }
  SECTION("where floats cannot hold the lengths") {
    for (const Quantum& q : scene.points) scene.classes.push_back(q[0] % 2 == 0 ? 2 : 1);
    ignored = {2};
    scale_up(scene, 1e15);
  }
  SECTION("that are the nearest at every pose, whole blocks of them") {
    scene.classes.resize(400);
    for (const Pose& pose : scene.query.poses) {
      for (int i = 0; i < 64; ++i) scene.add_point(pose.position());
    }
    scene.classes.resize(scene.points.size(), 18);
    ignored = {18};
  }
  const std::uint64_t left = check_engines(scene, {.reach = 1}).colliding();
  ignored.clear();
  CHECK(left > 0);
  CHECK(left < Expected(scene).colliding());
}

TEST_CASE("all points are ignored, or all that are exactly at the corner of a box") {
  PlainScene scene;
  SECTION("by class") { scene.query.ignore_classes = {0}; }
  SECTION("by box") { scene.query.ignore_boxes = {{{-9, -9, -9}, {9, 9, 9}}}; }
  SECTION("by a box of no size") {
    scene.set_points({transform(scene.query.poses[3], scene.query.model.vertices[2])});
    const Vec3 corner = positions_of(scene.points, scene.quantisation)[0];
    scene.points.resize(130, scene.points[0]);
    scene.query.ignore_boxes = {{corner, corner}};
    const Quantum q = scene.points[0];
    scene.points.resize(133, {q[0] + 1, q[1], q[2]});
    check_equal(check_engines(scene).colliding(), 3);
    return;
  }
  check_equal(check_engines(scene).colliding(), 0);
}

TEST_CASE("a floor above everything leaves nothing, and one below all of it") {
  PlainScene scene;
  scene.points.resize(1000);
  const std::uint64_t all = Expected(scene).colliding();
  scene.query.floor = 1e6;
  check_equal(check_engines(scene).colliding(), 0);
  scene.query.floor = -1e6;
  check_equal(check_engines(scene).colliding(), all);
}

TEST_CASE("points that are each touched by exactly one pose lose no hit among threads") {
  // Points on a line. The model is a comb: pose i touches point i of every `teeth`, so that poses
  // searched at the same time touch points that are neighbours in memory.
#ifdef CLEARWAY_SANITIZED
  constexpr std::int32_t kPoints = 1 << 14;
#else
  constexpr std::int32_t kPoints = 1 << 17;
#endif
  std::vector<Quantum> points;
  for (std::int32_t i = 0; i < kPoints; ++i) points.push_back({i, 0, 0});
  const MemoryCloud cloud(points, quantisation_of(1));
  for (const std::int32_t teeth : {32, 128, 512, 2048, 128, 512}) {
    const std::int32_t pitch = kPoints / teeth;
    Query query{{}, {}, {0.25}};
    for (std::int32_t i = 0; i < teeth; ++i)
      query.model.vertices.push_back({1.0 * i * pitch, 0, 0.1});
    for (std::int32_t i = 0; i < pitch; ++i) query.poses.push_back(translation({1.0 * i, 0.1, 0}));
    for (const Engine& engine : engines()) {
      CAPTURE(engine.name, teeth);
      CHECK(engine.run(cloud, query, 8).hits.count() == kPoints);
    }
  }
}
