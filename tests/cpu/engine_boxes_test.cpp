// Boxes that are accepted as a whole, because every point is within the radius of one model point,
// and boxes that just miss that.
#include <cmath>

#include "cpu/random_scene.hpp"
#include "support/catch.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// Points of a lattice whose farthest corner lies exactly 5 units from its first.
std::vector<Quantum> lattice() {
  std::vector<Quantum> points;
  for (std::int32_t y = 0; y <= 40; ++y) {
    for (std::int32_t x = 0; x <= 30; ++x) points.push_back({x, y, 0});
  }
  return points;
}

std::uint64_t colliding_of_lattice(const Vec3& offset, double radius) {
  const double unit = 0x1p-10;
  const Quantisation quantisation{{unit, unit, unit}, {offset.x, offset.y, offset.z}};
  const std::vector<Vec3> model{{0, 0, 0}};
  const std::vector<Pose> poses{translation(offset)};
  return check_engines(lattice(), quantisation, {model, poses, {radius}});
}

}  // namespace

TEST_CASE("a box whose farthest corner lies at the radius") {
  const double radius = 50 * 0x1p-10;
  const Vec3 offset = GENERATE(Vec3{0, 0, 0}, Vec3{5e6, 2e6, 1024});
  const std::uint64_t all = lattice().size();
  CHECK(colliding_of_lattice(offset, radius) == all - 1);
  CHECK(colliding_of_lattice(offset, std::nextafter(radius, 1)) == all);
  CHECK(colliding_of_lattice(offset, std::nextafter(radius, 0)) == all - 1);
}

TEST_CASE("radii far larger than boxes") {
  Scene scene;
  scene.points.resize(1500);
  scene.radius = GENERATE(0.9, 2.5, 30.0);
  CHECK(scene.check() > 100);
}
