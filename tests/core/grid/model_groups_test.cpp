#include "core/grid/model_groups.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/geometry/box.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/scenes.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("groups and parts hold every model point once, inside their spheres") {
  Random random(3);
  for (const std::size_t count : {1, 31, 32, 33, 1023, 1024, 1025, 5000}) {
    CAPTURE(count);
    const double size = count % 2 == 0 ? 1 : 1e7;
    auto points = random_points(random, {{-size, 0, 1}, {size, 2 * size, 1}}, count);
    const ModelGroups model(points);
    std::uint64_t outside = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3& m = model.points()[i];
      for (const GridSphere& sphere :
           {model.groups()[i / kGroupPoints], model.parts()[i / (kGroupPoints * kPartGroups)]}) {
        outside += squared_distance(m, sphere.centre) > sphere.radius * sphere.radius;
        outside += least_squared_distance(model.box(), sphere.centre) > 0;
      }
    }
    check_equal(outside, 0);
    CHECK(model.groups().size() == (count + kGroupPoints - 1) / kGroupPoints);
    const auto coordinates = [](const Vec3& p) { return std::tuple(p.x, p.y, p.z); };
    std::vector<Vec3> grouped(model.points().begin(), model.points().end());
    std::ranges::sort(points, {}, coordinates);
    std::ranges::sort(grouped, {}, coordinates);
    CHECK(points == grouped);
  }
}

TEST_CASE("groups are compact") {
  Random random(4);
  const ModelGroups model(random_points(random, {{0, 0, 0}, {1, 1, 1}}, 32768));
  double sum = 0;
  for (const GridSphere& group : model.groups()) sum += group.radius;
  CHECK(sum / static_cast<double>(model.groups().size()) < 0.12);  // 0.1 is half a cube's diagonal
}
