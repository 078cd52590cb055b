// Every engine against brute force on the way from a pose to the next.
#include <algorithm>
#include <cmath>

#include "core/geometry/predicate.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/engines/brute_force.hpp"
#include "support/engines/engines.hpp"
#include "support/scenes.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

constexpr std::uint32_t kNever = kNoPose;
const Quantisation kBinary{{0x1p-20, 0x1p-20, 0x1p-20}, {0, 0, 0}};
const Quantisation kMillimetre{{1e-3, 1e-3, 1e-3}, {0, 0, 0}};
const std::vector<Vec3> kOnePoint{{0, 0, 0}};
const Box kRoomOfWays{{-4, -3, -1}, {5, 4, 2}};

std::vector<std::uint32_t> first_poses(const std::vector<Vec3>& points,
                                       const std::vector<Vec3>& model,
                                       const std::vector<Pose>& poses, double radius) {
  return check_between_poses(quantise(points, kBinary), kBinary, {model, poses, {radius}});
}

std::uint64_t hits_of(const std::vector<std::uint32_t>& poses) {
  return static_cast<std::uint64_t>(
      std::count_if(poses.begin(), poses.end(), [](std::uint32_t p) { return p != kNever; }));
}

/// A cloud in kRoom and a model.
struct SceneOfWays {
  Random random{17};
  Quantisation quantisation = kMillimetre;
  std::vector<Quantum> points = quantise(random_points(random, kRoomOfWays, 2000), quantisation);
  std::vector<Vec3> model = random_points(random, {{-0.6, -0.4, -0.3}, {0.7, 0.5, 0.2}}, 40);

  /// Checks every engine between poses. Returns how many points collide there but at no pose.
  std::uint64_t check(const std::vector<Pose>& poses, double radius) const {
    const Query query{model, poses, {radius}};
    const auto discrete = brute_force_first_poses(positions_of(points, quantisation), query);
    return hits_of(check_between_poses(points, quantisation, query)) - hits_of(discrete);
  }
};

}  // namespace

TEST_CASE("one pose and repeated poses have the discrete answer between poses") {
  const SceneOfWays scene;
  const auto poses = GENERATE(as<std::size_t>(), 0, 1, 2, 50);
  Random random(2);
  const std::vector<Pose> still(poses, random_rotation(random, {0.5, 0.3, 0.2}));
  check_equal(scene.check(still, 0.4), 0);
}

TEST_CASE("a point that only the inside of a segment touches") {
  const std::vector<Pose> poses{translation({0, 0, 0}), translation({10, 0, 0})};
  const std::vector<Vec3> points{
      {5, 0.25, 0}, {5, -0.25, 0.25}, {5, 0.5, 0}, {-1, 0, 0}, {11, 0, 0}};
  CHECK(first_poses(points, kOnePoint, poses, 0.375) ==
        std::vector<std::uint32_t>{0, 0, kNever, kNever, kNever});
}

TEST_CASE("the first pose is that of the first way that touches the point, ends included") {
  std::vector<Pose> poses;
  for (int i = 0; i < 4; ++i) poses.push_back(translation({1.0 * i, 0, 0}));
  // Points at the start, inside each of the three segments, at and beside poses 1 and 2, at and
  // past the end.
  const std::vector<Vec3> points{{-0.0625, 0, 0}, {0.5, 0, 0}, {1.5, 0, 0},    {2.5, 0, 0},
                                 {1, 0.0625, 0},  {2, 0, 0},   {0.9375, 0, 0}, {3, 0, 0},
                                 {3.0625, 0, 0},  {3.5, 0, 0}};
  CHECK(first_poses(points, kOnePoint, poses, 0.125) ==
        std::vector<std::uint32_t>{0, 0, 1, 2, 0, 1, 0, 2, 2, kNever});
  // At a corner the model is near on the way to it, though nowhere nearer than at the corner's
  // pose.
  const std::vector<Pose> corner{translation({0, 0, 0}), translation({1, 0, 0}),
                                 translation({0, 0.03125, 0})};
  check_equal(first_poses({{1.0625, 0, 0}}, kOnePoint, corner, 0.125), {0});
}

TEST_CASE("a segment at exactly the radius and one unit to either side") {
  const std::vector<Pose> poses{translation({0, 0, 0}), translation({1, 0, 0}),
                                translation({1, 8, 0})};
  const std::vector<Vec3> points{{0.5, 0.5, 0}, {0.25, 0, -0.5}, {-0.5, 0, 0}, {1.5, 0, 0},
                                 {0, 0.5, 0},   {1, 0, 0.5},     {1, 8.5, 0},  {1.5, 0.125, 0}};
  check_equal(hits_of(first_poses(points, kOnePoint, poses, 0.5)), 0);
  check_equal(hits_of(first_poses(points, kOnePoint, poses, std::nextafter(0.5, 0))), 0);
  CHECK(first_poses(points, kOnePoint, poses, std::nextafter(0.5, 1)) ==
        std::vector<std::uint32_t>{0, 0, 0, 0, 0, 0, 1, 1});
}

TEST_CASE("a stop counts from the way that leads to it") {
  std::vector<Pose> poses(3, translation({0, 0, 0}));
  poses.insert(poses.end(), 40, translation({1, 0, 0}));
  poses.push_back(translation({2, 0, 0}));
  const std::vector<Vec3> points{{-0.0625, 0, 0}, {0, 0.0625, 0}, {1, 0.0625, 0}, {2.0625, 0, 0}};
  check_equal(first_poses(points, kOnePoint, poses, 0.125), {0, 0, 2, 42});
  CHECK(first_poses(points, kOnePoint, {translation({1, 0, 0})}, 0.125) ==
        std::vector<std::uint32_t>{kNever, kNever, 0, kNever});
}

TEST_CASE("turning on the spot in large steps: chords") {
  const SceneOfWays scene;
  const double step = GENERATE(0.5, 1.5707963267948966, 3.0, 3.141592653589793);
  std::vector<Pose> poses;
  for (int i = 0; i < 9; ++i) poses.push_back(rotation({0, 0, 1}, step * i, {0.5, 0.5, 0.3}));
  CHECK(scene.check(poses, 0.05) > 0);
}

TEST_CASE("jumps between poses") {
  SceneOfWays scene;
  const double far = GENERATE(10.0, 3e3, 1e7);
  const double utm = GENERATE(0.0, 5e6);
  std::vector<Pose> poses = smooth_path(scene.random, kRoomOfWays, 12);
  for (std::size_t i = 0; i < poses.size(); i += 3) {
    poses[i] = random_rotation(scene.random, {far, -0.5 * far, 0});
  }
  for (Pose& pose : poses) pose.translation[0] += utm;
  scene.quantisation.offset[0] = utm;
  CHECK(scene.check(poses, 0.1) > 0);
}

TEST_CASE("steps of one unit in the last place") {
  SceneOfWays scene;
  std::vector<Pose> poses{translation({0.5, 0.3, 0.2})};
  for (int i = 0; i < 30; ++i) {
    poses.push_back(poses.back());
    double& x = poses.back().translation[i % 3];
    x = std::nextafter(x, 10);
  }
  scene.check(poses, 0.3);
}

TEST_CASE("steps whose squared length underflows") {
  const double unit = GENERATE(1e-155, 1e-160, 1e-163, 1e-170);
  SceneOfWays scene;
  scene.quantisation = {{unit, unit, unit}, {0, 0, 0}};
  for (Quantum& q : scene.points) {
    for (int k = 0; k < 3; ++k) q[k] = static_cast<std::int32_t>(below(scene.random, 41)) - 20;
  }
  scene.model = {{0, 0, 0}};
  std::vector<Pose> poses;
  for (int i = 0; i < 5; ++i) poses.push_back(translation({7 * i * unit, i * unit, 0}));
  scene.check(poses, 4 * unit);
  scene.check(poses, 1e-150);
}

namespace {

struct Grazed {
  double length;  ///< length of the step
  double offset;  ///< distance of everything from the origin
  double jitter;  ///< metres by which the environment points are moved at random
  std::size_t model_points;
};

/// Checks model points on a line across their way, with environment points around one place beyond
/// the line's end at the radius from its segment: as far from the middle of the model as can be.
std::uint64_t check_grazed(Random& random, const Grazed& g, std::uint64_t& total) {
  const double radius = uniform(random, 0.05, 2);
  const Vec3 along = random_direction(random);
  const Vec3 other = random_direction(random);
  const Vec3 across{along.y * other.z - along.z * other.y, along.z * other.x - along.x * other.z,
                    along.x * other.y - along.y * other.x};
  const double width = std::sqrt(rounded_dot(across, across));
  const Vec3 away{across.x / width, across.y / width, across.z / width};
  const Pose from = random_rotation(random, {g.offset, -0.4 * g.offset, 1e-3 * g.offset});
  Pose to = from;
  for (int k = 0; k < 3; ++k) to.translation[k] += g.length * along[k];
  const std::vector<Pose> poses{from, to};
  std::vector<Vec3> model;
  for (std::size_t i = 0; i < g.model_points; ++i) {
    const double t = i < 2 ? 1.0 - static_cast<double>(i) : uniform(random, 0, 1);
    Vec3 m{};
    for (int k = 0; k < 3; ++k) {
      for (int row = 0; row < 3; ++row) m[k] += t * from.rotation[3 * row + k] * away[row];
    }
    model.push_back(m);
  }

  const Vec3 a = transform(from, model[0]), b = transform(to, model[0]);
  const double t = uniform(random, 0.01, 0.99);
  Quantisation quantisation{};
  for (int k = 0; k < 3; ++k) {
    quantisation.scale[k] = g.jitter / 64;
    quantisation.offset[k] = a[k] + t * (b[k] - a[k]) + radius * away[k];
  }
  std::vector<Quantum> points;
  for (int i = 0; i < 200; ++i) {
    Quantum q;
    for (int k = 0; k < 3; ++k) q[k] = static_cast<std::int32_t>(below(random, 129)) - 64;
    points.push_back(q);
  }
  total += points.size();
  return hits_of(check_between_poses(points, quantisation, {model, poses, {radius}}));
}

}  // namespace

TEST_CASE("points at the radius from a segment, rounding apart") {
  const Grazed grazed =
      GENERATE(Grazed{0.1, 0, 1e-15, 1}, Grazed{3, 0, 4e-15, 1}, Grazed{3, 5e6, 4e-9, 1},
               Grazed{2e3, 0, 1e-12, 1}, Grazed{2e3, 5e6, 4e-9, 20}, Grazed{3, 5e6, 4e-9, 2},
               Grazed{3, 0, 4e-15, 2}, Grazed{1e7, 0, 1e-8, 1}, Grazed{1e12, 0, 1e-3, 1},
               Grazed{1e-12, 1, 1e-15, 1});
  CAPTURE(grazed.length, grazed.offset, grazed.jitter, grazed.model_points);
  Random random(23);
  std::uint64_t total = 0, hits = 0;
  for (int i = 0; i < 40; ++i) hits += check_grazed(random, grazed, total);
  CHECK(hits > total / 20);
  CHECK(hits < total - total / 20);
}
