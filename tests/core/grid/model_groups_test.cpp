#include "core/grid/model_groups.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/geometry/predicate.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/scenes.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

std::vector<Vec3> sorted(std::span<const Vec3> points) {
  std::vector<Vec3> out(points.begin(), points.end());
  std::ranges::sort(out, {}, [](const Vec3& p) { return std::tuple(p.x, p.y, p.z); });
  return out;
}

void check_spheres(const ModelGroups& model, std::span<const GridSphere> spheres,
                   std::size_t points) {
  REQUIRE(spheres.size() == (model.points().size() + points - 1) / points);
  std::size_t outside = 0;
  for (std::size_t i = 0; i < model.points().size(); ++i) {
    const GridSphere& sphere = spheres[i / points];
    outside += squared_distance(model.points()[i], sphere.centre) > sphere.radius * sphere.radius;
    for (int k = 0; k < 3; ++k) {
      outside += sphere.centre[k] < model.box().lo[k] || sphere.centre[k] > model.box().hi[k];
    }
  }
  check_equal(outside, 0);
}

}  // namespace

TEST_CASE("groups and parts hold every model point once, inside their spheres") {
  Random random(3);
  for (const std::size_t count : {1, 31, 32, 33, 1023, 1024, 1025, 5000}) {
    const double size = count % 2 == 0 ? 1 : 1e7;
    const auto points = random_points(random, {{-size, 0, 1}, {size, 2 * size, 1}}, count);
    const ModelGroups model(points);
    CAPTURE(count);
    CHECK(sorted(points) == sorted(model.points()));
    check_spheres(model, model.groups(), kGroupPoints);
    check_spheres(model, model.parts(), kGroupPoints * kPartGroups);
  }
}

TEST_CASE("groups are compact") {
  Random random(4);
  const ModelGroups model(random_points(random, {{0, 0, 0}, {1, 1, 1}}, 32768));
  double sum = 0;
  for (const GridSphere& group : model.groups()) sum += group.radius;
  CHECK(sum / static_cast<double>(model.groups().size()) < 0.12);  // 0.1 is half a cube's diagonal
}

TEST_CASE("coordinates near the ends of double make spheres that dismiss nothing") {
  const std::vector<Vec3> points{{1e308, 0, 0}, {-1e308, 0, 0}, {0, 0, 0}};
  const ModelGroups model(points);
  CHECK(std::isinf(model.groups()[0].radius));
}
