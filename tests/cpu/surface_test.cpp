// Models of triangles: the sweep against brute force, bit for bit, in all modes.
#include <catch2/catch.hpp>
#include <cmath>

#include "support/engines/scene_checks.hpp"
#include "support/engines/tolerance_runs.hpp"
#include "support/surface_scene.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

const Box kRoom{{-4, -3, -1}, {5, 4, 2}};
const Box kPart{{-0.6, -0.4, -0.3}, {0.7, 0.5, 0.2}};

struct SurfaceScene : SceneChecks<SurfaceScene> {
  Random random{23};
  Quantisation quantisation{{1e-4, 1e-4, 1e-4}, {0, 0, 0}};
  std::vector<Quantum> points = quantise(random_points(random, kRoom, 500), quantisation);
  Surface surface = random_surface(random, kPart, 30);
  std::vector<Pose> poses = smooth_path(random, kRoom, 25);
  double radius = 0.2;

  Query query() const {
    Query query{surface.vertices, poses, {radius}};
    query.triangles = surface.triangles;
    return query;
  }
};

}  // namespace

TEST_CASE("surfaces of every kind") {
  SurfaceScene scene;
  SECTION("of all shapes of triangles") {}
  SECTION("a box of twelve large ones") { scene.surface = box_surface(kPart); }
  SECTION("one triangle") { scene.surface.triangles.resize(1); }
  SECTION("one that is a point") {
    scene.surface.triangles = {{2, 2, 2}};
    scene.radius = 0.6;
  }
  SECTION("one that is an edge") { scene.surface.triangles = {{2, 3, 2}}; }
  SECTION("the same one many times") {
    scene.surface.triangles.assign(30, scene.surface.triangles[0]);
  }
  SECTION("far from the model's origin") {
    for (Vec3& v : scene.surface.vertices) v = plus(v, 1, {1000, 2000, -50});
    for (Pose& pose : scene.poses) {
      const Vec3 moved = transform(pose, Vec3{1000, 2000, -50});
      for (int k = 0; k < 3; ++k) pose.translation[k] -= moved[k] - pose.translation[k];
    }
  }
  SECTION("in UTM coordinates") { scene.move_far_away({5e5, 5e6, 300}); }
  SECTION("with printed poses") {
    for (Pose& pose : scene.poses) pose = printed_with_six_digits(pose);
  }
  SECTION("stretched") {
    for (Pose& pose : scene.poses) pose = stretched(pose, {1.3, 0.7, 1});
  }
  SECTION("flattened") {
    for (Pose& pose : scene.poses) pose = stretched(pose, {1, 1, 0});
  }
  SECTION("one pose") { scene.poses.resize(1); }
  SECTION("one point") { scene.points.resize(1); }
  SECTION("a radius larger than the scene") { scene.radius = 30; }
  SECTION("a radius below all sizes") { scene.radius = 1e-3; }
  scene.check();
}

TEST_CASE("points on a surface and at the radius from it") {
  SurfaceScene scene;
  scene.poses.resize(8);
  const auto [radius, far] =
      GENERATE(table<double, bool>({{1e-9, false}, {0.05, false}, {0.05, true}, {3.0, true}}));
  scene.radius = radius;
  if (far) scene.move_far_away({-5e6, 5e5, 100});
  const std::vector<Vec3> places =
      places_beside(scene.random, scene.surface, scene.poses, radius, 300);
  // Quanta of about a rounding, so that places are where they are wanted.
  for (int k = 0; k < 3; ++k) {
    scene.quantisation.offset[k] = places[0][k];
    double reach = 1e-6;
    for (const Vec3& p : places) reach = std::max(reach, std::abs(p[k] - places[0][k]));
    scene.quantisation.scale[k] = reach / (1 << 30);
  }
  scene.points = quantise(places, scene.quantisation);
  CHECK(scene.check() > 0);
  for (const double clearance : {0.3 * radius, radius, 2.7 * radius}) {
    scene.check_clearance(clearance);
  }
}

TEST_CASE("random surfaces") {
#ifdef CLEARWAY_SANITIZED
  constexpr std::uint64_t kScenes = 30;
#else
  constexpr std::uint64_t kScenes = 500;
#endif
  std::uint64_t with_hits = 0;
  for (std::uint64_t seed = 1; seed <= kScenes; ++seed) {
    CAPTURE(seed);
    SurfaceScene scene;
    scene.random = Random(seed);
    Random& random = scene.random;
    const double size = std::exp(uniform(random, -3, 4));
    const Box room{{-size, -size, -size / 3}, {size, size, size / 3}};
    const double part = size * uniform(random, 0.01, 0.4);
    const bool large = seed % 100 == 0;
    scene.surface = random_surface(random, {{-part, -part, -part / 2}, {part, part, part}},
                                   1 + below(random, 30));
    scene.poses = smooth_path(random, room, 1 + below(random, large ? 40 : 12));
    // A radius far below the model's size takes a large field.
    scene.radius =
        large ? size * std::exp(uniform(random, -5, 0)) : part * std::exp(uniform(random, -1, 1.5));
    scene.quantisation = {{size * 1e-6, size * 1e-6, size * 2e-6}, {0, 0, 0}};
    scene.points = quantise(
        places_beside(random, scene.surface, scene.poses, 2 * scene.radius, large ? 200 : 30),
        scene.quantisation);
    if (below(random, 3) == 0) scene.move_far_away({5e5, 5e6, 300});
    const std::uint32_t cell_points = std::uint32_t{64} << below(random, 4);
    with_hits += check_engines(scene.points, scene.quantisation, scene.query(),
                               {cell_points, below(random, 2) * 100}) > 0;
  }
  CHECK(with_hits > kScenes / 2);
}

TEST_CASE("clearances of surfaces along slow paths") {
  SurfaceScene scene;
  scene.points.resize(200);
  const double bend = GENERATE(0.0, 1e-3, 0.5);
  scene.poses = slow_path(300, bend);
  SECTION("as they are") {}
  SECTION("of a box") { scene.surface = box_surface(kPart); }
  SECTION("with a stop") { scene.poses.insert(scene.poses.begin() + 200, 100, scene.poses[200]); }
  SECTION("to and fro") {
    const auto there = scene.poses;
    scene.poses.insert(scene.poses.end(), there.rbegin(), there.rend());
  }
  SECTION("far away") { scene.move_far_away({5e6, 2e6, 1e3}); }
  CHECK(scene.check_clearance(0.6) > 10);
  CHECK(scene.check_profile(0.6) > 10);
}

TEST_CASE("clearances and profiles of surfaces of every size") {
  SurfaceScene scene;
  const double distance = GENERATE(1e-7, 0.1, 0.2, 2.0, 1e150, 1e200);
  CAPTURE(distance);
  const std::uint64_t found = scene.check_clearance(distance);
  const std::uint64_t poses = scene.check_profile(distance);
  if (distance > 1e100) {
    CHECK(found == scene.points.size());
    CHECK(poses == scene.poses.size());
  }
}

TEST_CASE("surfaces within a tolerance") {
  SurfaceScene scene;
  const double tolerance = GENERATE(1e-12, 1e-3, 0.05);
  scene.poses.resize(20);
  const auto once = scene.poses;
  for (const Pose& pose : once) {
    Pose beside = pose;
    beside.translation[0] += 0.3 * tolerance;
    scene.poses.push_back(beside);
  }
  scene.points =
      quantise(places_beside(scene.random, scene.surface, scene.poses, scene.radius, 800),
               scene.quantisation);
  Query query = scene.query();
  query.tolerance = tolerance;
  CHECK(check_tolerance(scene.points, scene.quantisation, query).colliding > 0);
}
