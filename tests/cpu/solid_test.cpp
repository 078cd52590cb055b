// Models with solids: the sweep against brute force, bit for bit, in all modes.
#include <cmath>

#include "support/catch.hpp"
#include "support/engines/scene_checks.hpp"
#include "support/solid_scene.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

const Box kRoomOfSolids{{-4, -3, -1}, {5, 4, 2}};
const Box kPartOfSolids{{-0.6, -0.4, -0.3}, {0.7, 0.5, 0.2}};

struct SolidScene : SceneChecks<SolidScene> {
  Random random{29};
  Quantisation quantisation{{1e-4, 1e-4, 1e-4}, {0, 0, 0}};
  std::vector<Quantum> points = quantise(random_points(random, kRoomOfSolids, 600), quantisation);
  Bodies bodies;
  std::vector<Pose> poses = smooth_path(random, kRoomOfSolids, 40);
  double radius = 0.1;

  SolidScene() { bodies.add(box_surface(kPartOfSolids)); }

  Query query() const { return bodies.query(poses, radius); }
};

Surface moved_by(const Surface& body, const Vec3& by) {
  return mapped(body, [&](const Vec3& v) { return plus(v, 1, by); });
}

}  // namespace

TEST_CASE("solids of every kind") {
  SolidScene scene;
  SECTION("a box") {}
  SECTION("turned inwards") {
    scene.bodies = {};
    scene.bodies.add(turned_inwards(box_surface(kPartOfSolids)));
  }
  SECTION("a torus") {
    scene.bodies = {};
    scene.bodies.add(torus(0.4, 9, 5));
  }
  SECTION("overlapping ones") {
    scene.bodies.add(moved_by(box_surface(kPartOfSolids), {0.5, 0.3, 0.1}));
    scene.bodies.add(moved_by(unit_sphere(1), {-0.6, 0, 0.2}));
  }
  SECTION("with a cavity") {
    scene.bodies.add(turned_inwards(box_surface({{-0.3, -0.2, -0.2}, {0.5, 0.4, 0.1}})));
  }
  SECTION("beside and within open ones") {
    scene.bodies.add(random_surface(scene.random, kPartOfSolids, 20), false);
    Surface open = moved_by(box_surface(kPartOfSolids), {0, 1, 0});
    open.triangles.pop_back();
    scene.bodies.add(open, false);
  }
  SECTION("all open") { scene.bodies.solid_of.assign(12, kNoSolid); }
  SECTION("in UTM coordinates") { scene.move_far_away({5e5, 5e6, 300}); }
  SECTION("with printed poses") { print_with_six_digits(scene.poses); }
  SECTION("stretched") { stretch(scene.poses, {1.3, 0.7, 1}); }
  SECTION("mirrored") { stretch(scene.poses, {1, -1, 1}); }
  SECTION("flattened") { stretch(scene.poses, {1, 1, 0}); }
  SECTION("one pose") { scene.poses.resize(1); }
  SECTION("one point") { scene.points.resize(1); }
  SECTION("a radius larger than the scene") { scene.radius = 30; }
  SECTION("a radius below all sizes") {
    scene.bodies = {};
    scene.bodies.add(
        mapped(box_surface(kPartOfSolids), [](const Vec3& v) { return plus({}, 0.1, v); }));
    scene.radius = 1e-3;
  }
  scene.check();
}

TEST_CASE("ignored points are in no solid") {
  SolidScene scene;
  Query query = scene.query();
  std::vector<std::uint8_t> classes(scene.points.size());
  SECTION("by class") {
    for (std::uint8_t& value : classes) value = static_cast<std::uint8_t>(below(scene.random, 3));
    query.ignore_classes = {1};
  }
  SECTION("by box") {
    const double* at = scene.poses[20].translation;
    query.ignore_boxes = {{{at[0] - 1, at[1] - 1, at[2] - 1}, {at[0] + 1, at[1] + 1, at[2] + 1}}};
  }
  const std::uint64_t left = check_engines(scene.points, classes, scene.quantisation, query);
  CHECK(left > 0);
  CHECK(left < scene.check());
}

TEST_CASE("random solids") {
#ifdef CLEARWAY_SANITIZED
  constexpr std::uint64_t kScenes = 30;
#else
  constexpr std::uint64_t kScenes = 150;
#endif
  std::uint64_t with_hits = 0;
  for (std::uint64_t seed = 1; seed <= kScenes; ++seed) {
    CAPTURE(seed);
    SolidScene scene;
    scene.random = Random(seed);
    Random& random = scene.random;
    const double size = std::exp(uniform(random, -3, 4));
    const Box room{{-size, -size, -size / 3}, {size, size, size / 3}};
    const double part = size * uniform(random, 0.05, 0.4);
    const bool large = seed % 50 == 0;
    scene.bodies = {};
    for (std::uint64_t i = 0; i <= below(random, 3); ++i) {
      const Vec3 at = random_point(random, {{-part, -part, -part}, {part, part, part}});
      scene.bodies.add(moved_by(random_body(random, part, !large), at), below(random, 5) > 0);
    }
    if (below(random, 2) == 0) {
      scene.bodies.add(random_surface(random, {{-part, -part, -part}, {part, part, part}}, 5),
                       false);
    }
    scene.poses = smooth_path(random, room, 1 + below(random, large ? 40 : 12));
    // A radius far below the model's size takes a large field.
    scene.radius =
        large ? size * std::exp(uniform(random, -5, 0)) : part * std::exp(uniform(random, -0.7, 1));
    scene.quantisation = {{size * 1e-6, size * 1e-6, size * 2e-6}, {0, 0, 0}};
    const std::size_t count = large ? 150 : 20;
    const std::vector<Vec3> beside =
        places_beside(random, scene.bodies.surface, scene.poses, 2 * scene.radius, count);
    scene.points = quantise(beside, scene.quantisation);
    const auto anywhere = quantise(random_points(random, room, count), scene.quantisation);
    scene.points.insert(scene.points.end(), anywhere.begin(), anywhere.end());
    if (below(random, 3) == 0) scene.move_far_away({5e5, 5e6, 300});
    const std::uint32_t cell_points = std::uint32_t{64} << below(random, 4);
    with_hits += check_engines(scene.points, scene.quantisation, scene.query(),
                               {cell_points, below(random, 2) * 100}) > 0;
  }
  CHECK(with_hits > kScenes / 2);
}

TEST_CASE("depths along slow paths") {
  SolidScene scene;
  scene.points.resize(200);
  const double bend = GENERATE(0.0, 1e-3, 0.5);
  scene.poses = slow_path(300, bend);
  SECTION("as they are") {}
  SECTION("of two that overlap") { scene.bodies.add(moved_by(unit_sphere(1), {0.3, -0.5, 0.1})); }
  SECTION("with a stop") { stop_at(scene.poses, 200, 100); }
  SECTION("to and fro") { drive_back(scene.poses); }
  SECTION("far away") { scene.move_far_away({5e6, 2e6, 1e3}); }
  CHECK(scene.check_clearance(0.6) > 10);
  CHECK(scene.check_profile(0.6) > 10);
}

TEST_CASE("depths and profiles whatever distance is asked for") {
  SolidScene scene;
  scene.bodies.add(moved_by(unit_sphere(1), {0.4, 0.4, 0.4}));
  const double distance = GENERATE(1e-9, 0.1, 2.0, 1e150);
  CAPTURE(distance);
  const std::uint64_t found = scene.check_clearance(distance);
  CHECK(found > 20);
  CHECK(scene.check_profile(distance) > 10);
}

TEST_CASE("solids that hundreds of poses graze") {
  SolidScene scene;
  scene.bodies = {};
  scene.bodies.add(box_surface({{-3, -0.4, -0.3}, {3, 0.5, 0.2}}));
  scene.poses = slow_path(400, GENERATE(0.0, 0.05));
  std::vector<Vec3> walls;
  for (int i = 0; i < 400; ++i) {
    const double off = i % 5 == 0 ? -0.3 : scene.radius + uniform(scene.random, -0.01, 0.1);
    walls.push_back({uniform(scene.random, -1, 6), 0.5 + off, uniform(scene.random, -0.3, 0.2)});
  }
  scene.points = quantise(walls, scene.quantisation);
  CHECK(scene.check() > 0);
}
