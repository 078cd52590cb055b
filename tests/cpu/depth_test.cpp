// Signed distances of bodies whose depth is known, through walls of points: brute force against the
// formula, and every engine against brute force.
#include "engine_scenes.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// The signed distances of the scene's points, after a check of all engines.
std::vector<double> signed_distances(const EngineScene& scene) {
  const Expected expected = check_engines(scene, {.reach = 1});
  std::vector<double> distances;
  for (const Clearance& least : expected.clearances()) {
    distances.push_back(signed_root(least.squared));
  }
  return distances;
}

}  // namespace

TEST_CASE("a box driven through a wall is as deep as half its least side") {
  const Vec3 offset = GENERATE(Vec3{0, 0, 0}, Vec3{500000, 5000000, 300});
  PlainScene scene;
  scene.quantisation = quantisation_of(0x1p-20);
  scene.query = {solid_model(box_surface({{-0.5, -0.25, -0.75}, {0.5, 0.25, 0.75}})), {}, {0.05}};
  for (int i = -16; i <= 16; ++i) scene.query.poses.push_back(translation({i * 0x1p-4, 0, 0}));
  std::vector<Vec3> wall;
  for (int i = 0; i < 17 * 17; ++i) wall.push_back({0, i % 17 * 0.125 - 1, i / 17 * 0.125 - 1});
  scene.set_points(wall);
  const std::vector<Vec3> points = positions_of(scene.points, scene.quantisation);
  scene.move_far_away(offset);
  const std::vector<double> found = signed_distances(scene);
  for (std::size_t i = 0; i < points.size(); ++i) {
    // At the pose x = 0 the box is nearest by its sides along y and z.
    const double y = std::abs(points[i].y) - 0.25, z = std::abs(points[i].z) - 0.75;
    const double outside = std::hypot(std::max(y, 0.0), std::max(z, 0.0));
    const double expected = y < 0 && z < 0 ? std::max({y, z, -0.5}) : outside;
    CAPTURE(points[i].y, points[i].z);
    check_near(found[i], expected, offset.x > 0 ? 1e-8 : 1e-12);
  }
}

TEST_CASE("inside several solids the greatest depth counts") {
  const Box small{{-0.125, -0.125, -0.125}, {0.125, 0.125, 0.125}};
  Bodies bodies;
  bodies.add(box_surface({{-1, -1, -1}, {1, 1, 1}}));
  SECTION("a smaller one within does not make it less") { bodies.add(box_surface(small)); }
  SECTION("nor does a cavity") {
    bodies.add(turned_inwards(box_surface({{-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}})));
  }
  SECTION("nor an open part") {
    Surface open = box_surface(small);
    open.triangles.pop_back();
    bodies.add(open, false);
  }
  PlainScene scene;
  scene.query = {solid_model(bodies), {translation({0, 0, 0})}, {0.05}};
  scene.quantisation = quantisation_of(0x1p-20);
  scene.set_points({{0, 0, 0}, {0.75, 0, 0}, {0, 0, 1.5}});
  check_equal(signed_distances(scene), {-1, -0.25, 0.5});
}
