// The inside of solids against exact predicates (CGAL): the sign is right wherever the distance is
// above the bound of docs/design/model.md.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Side_of_triangle_mesh.h>
#include <CGAL/Surface_mesh.h>

#include <cmath>

#include "core/geometry/point_box.hpp"
#include "core/geometry/solid_parts.hpp"
#include "support/catch.hpp"
#include "support/solid_scene.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;

Mesh exact(const Surface& body) {
  Mesh mesh;
  std::vector<Mesh::Vertex_index> vertices;
  for (const Vec3& v : body.vertices) vertices.push_back(mesh.add_vertex({v.x, v.y, v.z}));
  for (const auto& [a, b, c] : body.triangles) {
    REQUIRE(mesh.add_face(vertices[a], vertices[b], vertices[c]) != Mesh::null_face());
  }
  return mesh;
}

double distance_to(const Surface& body, const Vec3& x) {
  double least = kInfinity;
  for (std::size_t i = 0; i < body.triangles.size(); ++i) {
    least = std::min(least, squared_distance(x, body.at(i)));
  }
  return std::sqrt(least);
}

}  // namespace

TEST_CASE("signs are right beyond their bound") {
  std::uint64_t inside = 0, near = 0, open = 0;
  for (std::uint64_t seed = 1; seed <= 4000; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    const double size = std::pow(10.0, uniform(random, -9, 6));
    Surface body = random_body(random, size);
    if (below(random, 3) == 0) {
      body = mapped(body, [](const Vec3& v) { return plus(v, 1, {5e5, 5e6, 100}); });
    }
    const Box box = box_of(body.vertices);
    const double side = std::max({box.hi.x - box.lo.x, box.hi.y - box.lo.y, box.hi.z - box.lo.z});
    if (side < 1e-4 * std::abs(box.hi.y)) continue;  // rounding may make the body cross itself
    const Mesh mesh = exact(body);
    const CGAL::Side_of_triangle_mesh<Mesh, Kernel> side_of(mesh);
    Bodies bodies;
    bodies.add(body);
    const SolidParts parts(bodies.query({}, 1).model);
    for (int i = 0; i < 60; ++i) {
      Vec3 x = random_place_at(random, body.at(below(random, body.triangles.size())));
      if (i % 4 == 0) x = random_point(random, box);
      const double distance = distance_to(body, x);
      if (distance <= 0x1p-39 * side) {
        ++open;
        continue;
      }
      const bool expected = side_of({x.x, x.y, x.z}) == CGAL::ON_BOUNDED_SIDE;
      inside += expected ? 1 : 0;
      near += distance < 1e-9 * side ? 1 : 0;
      CHECK(parts.ref().contains(x) == expected);
    }
  }
  WARN("inside " << inside << ", nearer than 1e-9 of the size " << near << ", below the bound "
                 << open);
  CHECK(inside > 5000);
  CHECK(near > 1000);
}
