// Every engine against brute force where rounding decides: points at the radius and a few units in
// the last place to either side, near the origin and far from it, and ties.
#include "core/geometry/predicate.hpp"
#include "engine_scenes.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/engines/boundary_scene.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

const std::vector<Pose> kNowhere{translation({0, 0, 0})};

void check_first_poses(const std::vector<Vec3>& places, const std::vector<Vec3>& model,
                       const std::vector<Pose>& poses, double radius,
                       const std::vector<std::uint32_t>& between_poses) {
  const Quantisation binary = quantisation_of(0x1p-20);
  const Expected expected =
      check_engines({quantise(places, binary), binary, {model, poses, {radius}}});
  check_equal(expected.first_poses(true), between_poses);
}

}  // namespace

TEST_CASE("points exactly at the radius and one unit to either side") {
  struct Row {
    const char* name;
    EngineScene scene;
    std::uint64_t at, above;  ///< how many collide at the radius and just above it
  };
  // The farthest corner of a lattice lies 50 units from its first, so the box of blocks is not
  // accepted as a whole.
  std::vector<Quantum> lattice;
  for (std::int32_t y = 0; y <= 40; ++y) {
    for (std::int32_t x = 0; x <= 30; ++x) lattice.push_back({x, y, 0});
  }
  const std::int32_t half = 1 << 19;
  const Vec3 utm{5e6, 2e6, 1024};
  const Row rows[] = {
      {"three points",
       {{{half, 0, 0}, {0, -half, 0}, {0, 0, half}},
        quantisation_of(0x1p-20),
        {{{0, 0, 0}}, kNowhere, {0.5}}},
       0,
       3},
      {"a whole node",
       {std::vector<Quantum>(500, {6, 8, 0}), quantisation_of(0.5), {{{0, 0, 0}}, kNowhere, {5}}},
       0,
       500},
      {"a box",
       {lattice, quantisation_of(0x1p-10), {{{0, 0, 0}}, kNowhere, {50 * 0x1p-10}}},
       lattice.size() - 1,
       lattice.size()},
      {"a box far away",
       {lattice, quantisation_of(0x1p-10, utm), {{{0, 0, 0}}, {translation(utm)}, {50 * 0x1p-10}}},
       lattice.size() - 1,
       lattice.size()},
  };
  for (Row row : rows) {
    const RowName name(row.name);
    double& radius = row.scene.query.radius;
    check_equal(check_engines(row.scene).colliding(), row.at);
    for (const double sign : {-1.0, 1.0}) {
      EngineScene nudged = row.scene;
      nudged.query.poses[0].translation[0] += sign * 0x1p-54;
      check_engines(nudged);
    }
    radius = std::nextafter(radius, 100);
    check_equal(check_engines(row.scene).colliding(), row.above);
    radius = std::nextafter(std::nextafter(radius, 0), 0);
    check_equal(check_engines(row.scene).colliding(), row.at);
  }
}

TEST_CASE("first poses of ways, ends included, worked out by hand") {
  constexpr std::uint32_t kNever = kNoPose;
  const auto along_x = [](const std::vector<double>& at) {
    std::vector<Pose> poses;
    for (const double x : at) poses.push_back(translation({x, 0, 0}));
    return poses;
  };
  const std::vector<Vec3> model{{0, 0, 0}};
  // Only the inside of the segment touches.
  check_first_poses({{5, 0.25, 0}, {5, -0.25, 0.25}, {5, 0.5, 0}, {-1, 0, 0}, {11, 0, 0}}, model,
                    along_x({0, 10}), 0.375, {0, 0, kNever, kNever, kNever});
  // At the start, inside each of three segments, at and beside poses 1 and 2, at and past the end.
  check_first_poses({{-0.0625, 0, 0},
                     {0.5, 0, 0},
                     {1.5, 0, 0},
                     {2.5, 0, 0},
                     {1, 0.0625, 0},
                     {2, 0, 0},
                     {0.9375, 0, 0},
                     {3, 0, 0},
                     {3.0625, 0, 0},
                     {3.5, 0, 0}},
                    model, along_x({0, 1, 2, 3}), 0.125, {0, 0, 1, 2, 0, 1, 0, 2, 2, kNever});
  // At a corner the model is near on the way to it, though nowhere nearer than at its pose.
  check_first_poses({{1.0625, 0, 0}}, model,
                    {translation({0, 0, 0}), translation({1, 0, 0}), translation({0, 0.03125, 0})},
                    0.125, {0});
  // A stop counts from the way that leads to it.
  std::vector<double> stops(43, 1);
  stops[0] = stops[1] = stops[2] = 0;
  stops.push_back(2);
  check_first_poses({{-0.0625, 0, 0}, {0, 0.0625, 0}, {1, 0.0625, 0}, {2.0625, 0, 0}}, model,
                    along_x(stops), 0.125, {0, 0, 2, 42});
  check_first_poses({{0, 0.0625, 0}, {1, 0.0625, 0}}, model, along_x({1}), 0.125, {kNever, 0});
  // Exactly at the radius from a segment, and one unit above it.
  const std::vector<Pose> bent{translation({0, 0, 0}), translation({1, 0, 0}),
                               translation({1, 8, 0})};
  const std::vector<Vec3> at_radius{{0.5, 0.5, 0}, {0.25, 0, -0.5}, {-0.5, 0, 0}, {1.5, 0, 0},
                                    {0, 0.5, 0},   {1, 0, 0.5},     {1, 8.5, 0},  {1.5, 0.125, 0}};
  check_first_poses(at_radius, model, bent, 0.5, std::vector<std::uint32_t>(8, kNever));
  check_first_poses(at_radius, model, bent, std::nextafter(0.5, 1), {0, 0, 0, 0, 0, 0, 1, 1});
}

TEST_CASE("ways of no length, and of the least") {
  PlainScene scene;
  scene.points.resize(1000);
  scene.query.radius = 0.1;
  std::vector<Pose>& poses = scene.query.poses;
  SECTION("one pose and repeated poses, which have the discrete answer") {
    poses = std::vector<Pose>(GENERATE(as<std::size_t>(), 1, 2, 50), Pose(poses[0]));
    scene.query.radius = 0.3;
  }
  SECTION("steps of one unit in the last place") {
    poses.resize(1);
    for (int i = 0; i < 30; ++i) {
      poses.push_back(poses.back());
      double& x = poses.back().translation[i % 3];
      x = std::nextafter(x, 10);
    }
  }
  SECTION("steps whose squared length underflows") {
    const double unit = GENERATE(1e-155, 1e-160, 1e-163, 1e-170);
    scene.quantisation = quantisation_of(unit);
    scene.points = random_quanta(scene.random, 1000, 20);
    scene.query.model = {{0, 0, 0}};
    poses.clear();
    for (int i = 0; i < 5; ++i) poses.push_back(translation({7 * i * unit, i * unit, 0}));
    scene.query.radius = GENERATE(4.0, 0.0) * unit;
    if (scene.query.radius == 0) scene.query.radius = 1e-150;
  }
  const Expected expected = check_engines(scene, {.packings = {{128, 0}}});
  CHECK(expected.colliding(true) >= expected.colliding());
}

TEST_CASE("points at the radius from a place or a way, rounding apart") {
  const Boundary boundary = GENERATE(from_range(std::begin(kBoundaries), std::end(kBoundaries)));
  INFO(boundary.name);
  Random random(11);
  std::uint64_t total = 0, colliding = 0;
  for (const std::size_t model_points : {1, 2, 40}) {
    for (const std::size_t poses : {1, 2, 30}) {
      for (int i = 0; i < 10; ++i) {
        const EngineScene scene = boundary_scene(random, boundary, model_points, poses);
        const Expected expected = check_engines(scene, {.packings = {{128, 0}}});
        colliding += expected.colliding(boundary.is_way);
        total += scene.points.size();
      }
    }
  }
  CHECK(colliding > total / 20);  // both answers occur many times
  CHECK(colliding < total - total / 20);
}

TEST_CASE("places on a model and at the radius, which is the distance of one of them") {
  PlainScene scene(GENERATE(Kind::kPoints, Kind::kSurface, Kind::kSolids));
  Random& random = scene.random;
  scene.query.poses.resize(4);
  const double radius = GENERATE(1e-9, 0.05, 3.0);
  if (GENERATE(false, true)) scene.move_far_away({-5e6, 5e5, 100});
  const std::vector<Vec3> places = places_beside(random, scene.query, radius, 100);
  // Quanta are about as large as a rounding, so that places are where they are wanted.
  double size = 1e-6;
  for (const Vec3& p : places) size = std::max(size, length_of(difference(p, places[0])));
  scene.quantisation = quantisation_of(size / (1 << 30), places[0]);
  scene.set_points(places);
  // The radius and the reach are least distances of points and poses, to the last bit and beside
  // it.
  const Expected distances(scene);
  const double squared = distances.clearances()[below(random, 100)].squared;
  double reach = std::nextafter(std::sqrt(std::abs(distances.nearest()[0].squared)), 0);
  if (squared > 0) scene.query.radius = std::nextafter(std::sqrt(squared), 0);
  for (int step = 0; step < 4; ++step) {
    check_engines(scene, {.reach = reach, .packings = {{64, 0}}});
    scene.query.radius = std::nextafter(scene.query.radius, 10);
    reach = std::nextafter(reach, 10);
  }
  CHECK(Expected(scene).colliding() > 0);
}

TEST_CASE("clearances that mirror images tie for: the earlier pose wins") {
  // Points in the plane x = 0 and poses at -x and x, all in exact numbers.
  EngineScene scene{{}, quantisation_of(0x1p-10), {{}, {}, {0.1}}};
  for (std::int32_t i = 0; i < 900; ++i) scene.points.push_back({0, i % 30 * 64, i / 30 * 32});
  const bool towards = GENERATE(false, true);
  for (int i = -32; i <= 32; ++i) {
    if (i == 0) continue;
    scene.query.poses.push_back(translation({(towards ? i : -i) * 0x1p-5, 0.5, 0.25}));
  }
  scene.query.model = {{0, 0, 0}, {0, 0.25, 0}, {0, 0, 0.5}};
  check_engines(scene, {.reach = 4});
  scene.query.model = {{0.5, 0, 0}, {-0.5, 0, 0}};  // ties between model points, too
  check_engines(scene, {.reach = 4});
}

TEST_CASE("profiles for which whole planes of points tie: the lowest index wins") {
  PlainScene scene;
  scene.quantisation = quantisation_of(0x1p-10);
  scene.points.clear();
  for (std::int32_t i = 0; i < 2500; ++i) scene.points.push_back({i % 50 * 64, i / 50 * 64, 0});
  std::ranges::shuffle(scene.points, scene.random);
  scene.query.model = {};
  for (int i = 0; i < 64; ++i) {
    scene.query.model.vertices.push_back({i % 8 * 0x1p-4, i / 8 * 0x1p-4, 0.25});
  }
  scene.query.poses.clear();
  for (int i = 0; i < 40; ++i) scene.query.poses.push_back(translation({i * 0x1p-6, 0.5, 0}));
  const double reach = GENERATE(4.0, 0.25, 0.25 + 0x1p-54);
  CHECK(check_engines(scene, {.reach = reach}).nearest()[0].squared == 0.0625);
}

TEST_CASE(
    "clearances and profiles where roundings decide the pose, the point and the model point") {
  // A model on a sphere around points at its middle, or a model at the middle of a sphere of
  // points, at poses that differ by as little as roundings do: the least computed d2 is not that of
  // the nearest point.
  Random random(23);
  for (int trial = 0; trial < 60; ++trial) {
    CAPTURE(trial);
    const double far = trial % 3 == 0 ? 0 : trial % 3 == 1 ? 1e3 : 5e6;
    const bool is_profile = trial >= 40;
    const double ulp = std::max(far, 1.0) * 0x1p-52;
    const Vec3 centre{far, -0.7 * far, 0.3 * far};
    EngineScene scene{{}, quantisation_of(is_profile ? 1e-9 : ulp, centre), {{}, {}, {0.1}}};
    for (int i = 0; i < 40; ++i) {
      scene.query.model.vertices.push_back(
          is_profile ? plus({}, 1e-9 * uniform(random, 0, 1), random_direction(random))
                     : plus({}, 0.5, random_direction(random)));
      scene.query.poses.push_back(random_rotation(
          random, is_profile ? centre : plus(centre, 4 * ulp, random_direction(random))));
    }
    scene.points = random_quanta(random, 40, 2);
    std::vector<Vec3> sphere;
    for (int i = 0; i < 200; ++i) sphere.push_back(plus(centre, 0.5, random_direction(random)));
    if (is_profile) scene.points = quantise(sphere, scene.quantisation);
    check_equal(check_engines(scene, {.reach = 0.9, .packings = {{64, 0}}}).colliding(), 0);
  }
}
