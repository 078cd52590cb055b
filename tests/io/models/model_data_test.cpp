// The meshes of real vehicles.
#include <cmath>
#include <random>

#include "clearway/model.hpp"
#include "core/geometry/model_tree.hpp"
#include "core/geometry/predicate.hpp"
#include "io/models/model_input.hpp"
#include "support/catch.hpp"
#include "support/surface_places.hpp"
#include "support/test_data.hpp"
#include "support/triangle_distance.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("the surface of a real vehicle is covered") {
  const std::string name = GENERATE("prius.obj", "warthog_ugv.obj");
  const auto path = data_folder() / "street" / name;
  const TriangleMesh mesh = read_model_input(path, {}).mesh;
  const double spacing = 0.025;
  const std::vector<Vec3> points = read_model_points(path, {.spacing = spacing});
  const ModelTree tree(points);
  double farthest = 0;
  for_places(mesh, 4, [&](const Vec3& place) {
    farthest = std::max(farthest, std::sqrt(tree.nearest(place).squared_distance));
  });
  CHECK(farthest <= spacing);
  CHECK(farthest > 0.9 * spacing);
}

TEST_CASE("samples of a real vehicle find what touches its surface") {
  const auto path = data_folder() / "street" / "prius.obj";
  const TriangleMesh mesh = read_model_input(path, {}).mesh;
  const double spacing = 0.025, radius = 0.1;
  const ModelTree tree(read_model_points(path, {.spacing = spacing}));
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> x(-1.3, 1.3), y(-2.6, 2.7), z(-0.1, 1.8);
  int hits = 0;
  for (int i = 0; i < 4000; ++i) {
    const Vec3 e{x(random), y(random), z(random)};
    const bool hit = tree.nearest(e).squared_distance < radius * radius;
    const double distance = surface_distance(e, mesh);
    if (hit && !(distance < radius + 1e-13)) FAIL("a false hit at " << distance);
    if (!hit && distance <= radius - spacing) FAIL("a miss at " << distance);
    hits += hit ? 1 : 0;
  }
  CHECK(hits > 500);
}
