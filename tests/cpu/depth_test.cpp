// Penetration depths of bodies whose depth is known, through walls of points.
#include <cmath>
#include <limits>

#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/engines/engines.hpp"
#include "support/solid_scene.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// Points in a plane x = 0, on a grid of `step` over 2 m by 2 m.
std::vector<Vec3> wall(double step) {
  std::vector<Vec3> points;
  for (double y = -1; y <= 1; y += step) {
    for (double z = -1; z <= 1; z += step) points.push_back({0, y, z});
  }
  return points;
}

/// The signed distances of all points by every engine that has clearances, after a check that all
/// agree.
std::vector<double> signed_distances(const std::vector<Vec3>& points, const Vec3& offset,
                                     Query query) {
  const Quantisation quantisation{{0x1p-20, 0x1p-20, 0x1p-20}, {offset.x, offset.y, offset.z}};
  std::vector<Quantum> quanta;
  quanta.reserve(points.size());
  for (const Vec3& p : points) {
    quanta.push_back({static_cast<std::int32_t>(std::round(p.x * 0x1p20)),
                      static_cast<std::int32_t>(std::round(p.y * 0x1p20)),
                      static_cast<std::int32_t>(std::round(p.z * 0x1p20))});
  }
  query.clearance = 1;
  for (Pose& pose : query.poses) {
    for (int k = 0; k < 3; ++k) pose.translation[k] += offset[k];
  }
  const MemoryCloud cloud(quanta, quantisation, {128, 0});
  std::vector<double> distances(points.size(), std::numeric_limits<double>::quiet_NaN());
  for (const Engine& engine : engines()) {
    if (!engine.finds_all) continue;
    const SearchResult answer = engine.run(cloud, query, 1);
    for (std::uint64_t slot = 0; slot < cloud.entry_count(); ++slot) {
      if (!cloud.is_used(slot)) continue;
      const double v = answer.clearances.at(slot).squared;
      distances[cloud.source(slot)] = v < 0 ? -std::sqrt(-v) : std::sqrt(v);
    }
  }
  return distances;
}

/// Poses along x that only move, so that a body's frame is parallel to the environment's.
std::vector<Pose> along_x(double from, double to, int count) {
  std::vector<Pose> poses;
  poses.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i)
    poses.push_back(translation({from + (to - from) * i / (count - 1), 0, 0}));
  return poses;
}

}  // namespace

TEST_CASE("a box driven through a wall is as deep as half its least side") {
  const Vec3 offset = GENERATE(Vec3{0, 0, 0}, Vec3{500000, 5000000, 300});
  const double rounding = offset.x > 0 ? 1e-8 : 1e-12;
  Bodies bodies;
  bodies.add(box_surface({{-0.5, -0.25, -0.75}, {0.5, 0.25, 0.75}}));
  const std::vector<Vec3> points = wall(0.0625);
  const Query query = bodies.query(along_x(-1, 1, 33), 0.05);  // steps of 1/16
  const std::vector<double> found = signed_distances(points, offset, query);
  for (std::size_t i = 0; i < points.size(); ++i) {
    // At the pose x = 0 the box is nearest by its sides along y and z.
    const double y = std::abs(points[i].y) - 0.25, z = std::abs(points[i].z) - 0.75;
    const double outside = std::hypot(std::max(y, 0.0), std::max(z, 0.0));
    const double expected = y < 0 && z < 0 ? std::max({y, z, -0.5}) : outside;
    CAPTURE(points[i].y, points[i].z);
    CHECK(found[i] == Approx(expected).margin(rounding).epsilon(0));
  }
}

TEST_CASE("a sphere and a torus are as deep as their triangles") {
  // Vertices lie on the body, so triangles are nearer to its middle by the height of their caps.
  const bool is_torus = GENERATE(false, true);
  const Surface body = is_torus ? torus(0.25, 96, 48) : unit_sphere(3);
  const double cap = is_torus ? 0.003 : 0.016;
  Bodies bodies;
  bodies.add(body);
  const std::vector<Vec3> points = wall(0.25);
  const Query query = bodies.query(along_x(-1.5, 1.5, 97), 0.05);
  const std::vector<double> found = signed_distances(points, {0, 0, 0}, query);
  for (std::size_t i = 0; i < points.size(); ++i) {
    double exact = kInfinity;
    for (const Pose& pose : query.poses) {
      const Vec3 x = difference(points[i], {pose.translation[0], 0, 0});
      exact = std::min(
          exact, is_torus ? std::hypot(std::hypot(x.x, x.y) - 1, x.z) - 0.25 : length_of(x) - 1);
    }
    CAPTURE(points[i].y, points[i].z);
    if (exact >= 1) continue;  // beyond the clearance asked for
    CHECK(found[i] >= exact - 1e-12);
    CHECK(found[i] <= exact + cap);
  }
  CHECK(*std::min_element(found.begin(), found.end()) < (is_torus ? -0.24 : -0.98));
}

TEST_CASE("inside several solids the greatest depth counts") {
  Bodies bodies;
  bodies.add(box_surface({{-1, -1, -1}, {1, 1, 1}}));
  SECTION("a smaller one within does not make it less") {
    bodies.add(box_surface({{-0.125, -0.125, -0.125}, {0.125, 0.125, 0.125}}));
  }
  SECTION("nor does a cavity") {
    bodies.add(turned_inwards(box_surface({{-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}})));
  }
  SECTION("nor an open part") {
    Surface open = box_surface({{-0.125, -0.125, -0.125}, {0.125, 0.125, 0.125}});
    open.triangles.pop_back();
    bodies.add(open, false);
  }
  const Query query = bodies.query({translation({0, 0, 0})}, 0.05);
  const auto found = signed_distances({{0, 0, 0}, {0.75, 0, 0}, {0, 0, 1.5}}, {0, 0, 0}, query);
  check_equal(found[0], -1);
  check_equal(found[1], -0.25);
  check_equal(found[2], 0.5);
}

TEST_CASE("what is far inside collides") {
  Bodies bodies;
  bodies.add(box_surface({{-100, -100, -100}, {100, 100, 100}}));
  Query query = bodies.query({translation({0, 0, 0}), translation({300, 0, 0})}, 1e-3);
  const std::vector<Quantum> points{{0, 0, 0}, {99, 99, 99}, {101, 0, 0}, {201, 0, 0}, {250, 1, 2}};
  check_equal(check_engines(points, {{1, 1, 1}, {0, 0, 0}}, query), 4);
}
