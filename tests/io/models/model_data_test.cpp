// The meshes of real vehicles.
#include <cmath>

#include "clearway/model.hpp"
#include "core/geometry/model_tree.hpp"
#include "io/models/model_input.hpp"
#include "support/catch.hpp"
#include "support/surface_places.hpp"
#include "support/test_data.hpp"

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
