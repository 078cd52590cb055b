// Models of triangles: the sweep against brute force, bit for bit, in all modes.
#include <cmath>

#include "core/geometry/point_box.hpp"
#include "core/geometry/triangle_box.hpp"
#include "core/sweep/block_descent.hpp"
#include "core/sweep/sweep_filter.hpp"
#include "support/catch.hpp"
#include "support/engines/scene_checks.hpp"
#include "support/engines/tolerance_runs.hpp"
#include "support/surface_scene.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

const Box kRoomOfSurfaces{{-4, -3, -1}, {5, 4, 2}};
const Box kPartOfSurfaces{{-0.6, -0.4, -0.3}, {0.7, 0.5, 0.2}};

struct SurfaceScene : SceneChecks<SurfaceScene> {
  Random random{23};
  Quantisation quantisation{{1e-4, 1e-4, 1e-4}, {0, 0, 0}};
  std::vector<Quantum> points = quantise(random_points(random, kRoomOfSurfaces, 500), quantisation);
  Surface surface = random_surface(random, kPartOfSurfaces, 30);
  std::vector<Pose> poses = smooth_path(random, kRoomOfSurfaces, 25);
  double radius = 0.2;

  Query query() const {
    Query query{surface.vertices, poses, {radius}};
    query.model.triangles = surface.triangles;
    return query;
  }
};

}  // namespace

TEST_CASE("surfaces of every kind") {
  SurfaceScene scene;
  SECTION("of all shapes of triangles") {}
  SECTION("a box of twelve large ones") { scene.surface = box_surface(kPartOfSurfaces); }
  SECTION("one triangle") { scene.surface.triangles.resize(1); }
  SECTION("one that is a point") {
    scene.surface.triangles = {{2, 2, 2}};
    scene.radius = 0.6;
  }
  SECTION("one that is an edge") { scene.surface.triangles = {{2, 3, 2}}; }
  SECTION("lines and single points, as meshes draw them") {
    auto& triangles = scene.surface.triangles;
    triangles.clear();
    for (std::uint32_t i = 1; i + 1 < 40; ++i) triangles.push_back({i, i + 1, i + 1});
    for (std::uint32_t i = 40; i < 60; ++i) triangles.push_back({i, i, i});
  }
  SECTION("one that is a segment") { scene.surface.triangles = {{2, 3, 3}}; }
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
  SECTION("with printed poses") { print_with_six_digits(scene.poses); }
  SECTION("stretched") { stretch(scene.poses, {1.3, 0.7, 1}); }
  SECTION("flattened") { stretch(scene.poses, {1, 1, 0}); }
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
  // Quanta are about as large as a rounding, so that places are where they are wanted.
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
  constexpr std::uint64_t kScenes = 150;
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
    const bool large = seed % 50 == 0;
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
  SECTION("of a box") { scene.surface = box_surface(kPartOfSurfaces); }
  SECTION("with a stop") { stop_at(scene.poses, 200, 100); }
  SECTION("to and fro") { drive_back(scene.poses); }
  SECTION("far away") { scene.move_far_away({5e6, 2e6, 1e3}); }
  CHECK(scene.check_clearance(0.6) > 10);
  CHECK(scene.check_profile(0.6) > 10);
}

TEST_CASE("clearances and profiles of lines and single points") {
  SurfaceScene scene;
  scene.surface = box_surface(kPartOfSurfaces);
  scene.surface.triangles = {{0, 7, 7}, {1, 1, 1}, {4, 4, 4}};
  SECTION("beside each other") {}
  SECTION("a mast alone") { scene.surface.triangles.resize(1); }
  SECTION("along a slow path") { scene.poses = slow_path(100, 1e-3); }
  CHECK(scene.check_clearance(1.5) > 0);
  CHECK(scene.check_profile(1.5) > 0);
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
  CHECK(check_tolerance(scene.points, scene.quantisation, scene.query(), tolerance).colliding > 0);
}

namespace {

/// A long load of few triangles, and walls beside it between which it just fits.
struct GrazingScene : SurfaceScene {
  explicit GrazingScene(double bend) {
    surface = box_surface({{-3, -0.4, -0.3}, {3, 0.5, 0.2}});
    poses = slow_path(400, bend);
    std::vector<Vec3> walls;
    for (int i = 0; i < 500; ++i) {
      const double off = radius + uniform(random, -0.01, 0.1);
      const double x = uniform(random, -1, 6);
      walls.push_back(i % 2 == 0 ? Vec3{x, 0.5 + off, uniform(random, -0.3, 0.2)}
                                 : Vec3{x, uniform(random, -0.4, 0.5), 0.2 + off});
    }
    points = quantise(walls, quantisation);
  }
};

}  // namespace

TEST_CASE("surfaces that hundreds of poses graze") {
  GrazingScene scene(GENERATE(0.0, 1e-3, 0.05));
  scene.points.resize(250);
  SECTION("as they are") {}
  SECTION("with a stop") { stop_at(scene.poses, 200, 100); }
  SECTION("to and fro") { drive_back(scene.poses); }
  SECTION("with a jump") {
    for (std::size_t i = 200; i < 400; ++i) scene.poses[i].translation[1] += 0.03;
  }
  SECTION("far away") { scene.move_far_away({5e6, 2e6, 1e3}); }
  SECTION("with printed poses") { print_with_six_digits(scene.poses); }
  CHECK(scene.check() > 0);
}

namespace {

/// A grazing scene with what a filter of it needs.
struct GrazingFilter {
  GrazingScene scene{1e-3};
  Query query = scene.query();
  MemoryCloud cloud{scene.points, scene.quantisation};
  TriangleTree model{triangles_of(query.model)};
  ModelField field{model, query.radius, {}, 1};
  MotionTree motion{query.poses, model.box()};
  SweepFilterOf<Triangle> filter{query, motion, model, field, cloud};
};

/// Searches a point by poses alone, without runs, and returns its first pose.
std::uint32_t first_pose_by_poses(const SweepFilterOf<Triangle>& filter, const Vec3& e,
                                  const std::vector<std::uint32_t>& nodes, SweepStatistics& tests) {
  std::uint32_t best = kNoPose;
  for (const std::uint32_t index : nodes) {
    const MotionNode& node = filter.motion().nodes()[index];
    const SweepVerdict verdict = filter.ref().look(e, node, tests);
    if (verdict == SweepVerdict::kDismissed) continue;
    if (verdict == SweepVerdict::kHitAtMid) best = std::min(best, node.mid);
    if (node.count > 1) {
      filter.lower_first_pose(e, index, best, tests);
    } else if (filter.ref().collides_at(e, node)) {
      best = std::min(best, node.first);
    }
  }
  return best;
}

}  // namespace

TEST_CASE("runs of poses take a fraction of the tests that single poses do") {
  const GrazingFilter made;
  const GrazingScene& scene = made.scene;
  const SweepFilterOf<Triangle>& filter = made.filter;
  SweepStatistics by_poses, by_runs, narrowing;
  std::uint64_t grazing = 0;
  for (const Quantum& point : scene.points) {
    const Vec3 e = position(scene.quantisation, point[0], point[1], point[2]);
    std::vector<std::uint32_t> nodes, runs;
    filter.narrow({plus(e, -1, {0.1, 0.1, 0.1}), plus(e, 1, {0.1, 0.1, 0.1})},
                  std::vector<std::uint32_t>{0}, nodes, narrowing);
    SweepStatistics tests;
    const std::uint32_t first_pose = first_pose_by_poses(filter, e, nodes, tests);
    filter.join_runs(filter.cost_of(tests), nodes, runs);
    if (runs.empty()) continue;
    ++grazing;
    by_poses.add(tests);
    CHECK(runs.size() < nodes.size());
    CHECK(filter.touches_runs(e, runs, by_runs) == (first_pose != kNoPose));
    SweepStatistics unused;
    CHECK(filter.first_pose_of_runs(e, runs, unused) == first_pose);
  }
  CHECK(grazing > 40);
  CHECK(8 * by_runs.point_tests < by_poses.point_tests);
}

TEST_CASE("a point that is searched in runs is counted once") {
  const GrazingFilter made;
  const GrazingScene& scene = made.scene;
  const SweepFilterOf<Triangle>& filter = made.filter;
  BlockDescentOf<Triangle> descent(filter);
  SweepStatistics narrowing, of_sets, of_first_poses;
  std::uint64_t searched = 0;
  for (std::size_t first = 0; first + kBlockPoints <= scene.points.size(); first += kBlockPoints) {
    std::vector<Vec3> points;
    for (std::uint32_t i = 0; i < kBlockPoints; ++i) {
      const Quantum& point = scene.points[first + i];
      const Vec3 e = position(scene.quantisation, point[0], point[1], point[2]);
      for (int k = 0; k < 3; ++k) descent.points().at[k][i] = e[k];
      points.push_back(e);
    }
    std::vector<std::uint32_t> nodes;
    filter.narrow(box_of(std::span<const Vec3>(points)), std::vector<std::uint32_t>{0}, nodes,
                  narrowing);
    std::uint32_t first_poses[kBlockPoints];
    const std::uint64_t all = ~std::uint64_t{0};
    CHECK(descent.touches(all, nodes, of_sets) ==
          descent.find_first_poses(all, nodes, first_poses, of_first_poses));
    searched += kBlockPoints;
  }
  CHECK(searched > 0);
  check_equal(of_sets.points_tested, searched);
  check_equal(of_first_poses.points_tested, searched);
}
