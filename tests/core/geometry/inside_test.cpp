// Which places lie inside a solid, with bodies whose inside is known.
#include "core/geometry/inside.hpp"

#include "core/geometry/point_box.hpp"
#include "core/geometry/rigid.hpp"
#include "core/geometry/solid_parts.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/solid_scene.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

int winding(const Surface& body, const Vec3& x) {
  const SolidLattice lattice(box_of(body.vertices));
  if (!lattice.has_in_box(x)) return 0;
  int sum = 0;
  for (std::size_t i = 0; i < body.triangles.size(); ++i) {
    sum += winding_above(lattice, lattice.place_of(x), body.at(i));
  }
  return sum;
}

}  // namespace

TEST_CASE("a box contains what lies between its sides") {
  const Box box{{-1, 2, 5}, {3, 4, 5.5}};
  const Surface body = box_surface(box);
  Random random(5);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 x = random_point(random, {{-2, 1, 4.5}, {4, 5, 6}});
    bool inside = true;
    for (int k = 0; k < 3; ++k) inside = inside && x[k] > box.lo[k] && x[k] < box.hi[k];
    CHECK(winding(body, x) == (inside ? 1 : 0));
    CHECK(winding(turned_inwards(body), x) == (inside ? -1 : 0));
  }
}

TEST_CASE("above edges and corners nothing is lost or counted twice") {
  // Exactly above and below diagonals of the faces, and along vertical faces.
  const Surface box = box_surface({{0, 0, 0}, {2, 2, 2}}), octahedron = unit_sphere(0);
  for (const double x : {0.5, 1.0, 1.5}) {
    for (const double y : {0.5, 1.0, 1.5}) check_equal(winding(box, {x, y, 1}), 1);
  }
  for (const double x : {-0.99, -0.5, 0.0, 0.25, 0.99}) {
    check_equal(winding(octahedron, {0, 0, x}), 1);
    check_equal(winding(octahedron, {x, 0, 0}), 1);
    check_equal(winding(octahedron, {x, 0, std::abs(x) > 0.1 ? 0.9 : -1.1}), 0);
    check_equal(winding(octahedron, {0, x, std::abs(x) > 0.1 ? -0.9 : 1.1}), 0);
  }
}

TEST_CASE("in line with a turned wall nothing is inside") {
  Random random(11);
  for (int i = 0; i < 300; ++i) {
    // A turn about z keeps the wall vertical.
    const double angle = uniform(random, 0, 6.3), c = std::cos(angle), s = std::sin(angle);
    const Surface body = mapped(box_surface({{0, 0, 0}, {1, 3, 1}}), [&](const Vec3& v) {
      return Vec3{c * v.x - s * v.y, s * v.x + c * v.y, v.z};
    });
    const double along = uniform(random, 0, 3), z = uniform(random, -1, 0);
    for (const double off : {0.0, 1e-17, -1e-17, 1e-16, -1e-16}) {
      check_equal(winding(body, {-s * along + off, c * along, z - 1e-6}), 0);
    }
  }
}

TEST_CASE("spheres and tori of any size and thinness") {
  const double size = GENERATE(1e-75, 1e-9, 1.0, 1e6, 1e75);
  const Surface sphere = mapped(unit_sphere(3), [&](const Vec3& v) { return plus({}, size, v); });
  const Surface ring =
      mapped(torus(0.25, 60, 30), [&](const Vec3& v) { return plus({}, size, v); });
  Random random(7);
  int inside = 0;
  for (int i = 0; i < 500; ++i) {
    const Vec3 at = plus({}, uniform(random, 0, 1.4), random_direction(random));
    const Vec3 x = plus({}, size, at);
    const double to_sphere = length_of(at) - 1;
    if (std::abs(to_sphere) > 0.02) CHECK(winding(sphere, x) == (to_sphere < 0 ? 1 : 0));
    const double to_ring = std::hypot(std::hypot(at.x, at.y) - 1, at.z) - 0.25;
    if (std::abs(to_ring) > 0.02) CHECK(winding(ring, x) == (to_ring < 0 ? 1 : 0));
    inside += to_ring < -0.02 ? 1 : 0;
  }
  CHECK(inside > 10);
}

TEST_CASE("trees of solids give the sums of all triangles") {
  Random random(3);
  for (int scene = 0; scene < 60; ++scene) {
    CAPTURE(scene);
    Bodies bodies;
    for (std::uint64_t i = 0; i <= below(random, 3); ++i) bodies.add(random_body(random, 1));
    bodies.add(random_surface(random, {{-1, -1, -1}, {1, 1, 1}}, 5), false);
    const SolidParts parts(bodies.query({}, 1).model);
    const SolidLattice lattice = parts.ref().lattice;
    for (int i = 0; i < 300; ++i) {
      Vec3 x = random_place_at(random, bodies.surface.at(below(random, bodies.solid_of.size())));
      if (below(random, 3) == 0) {
        x = bodies.surface.vertices[below(random, bodies.surface.vertices.size())];
      }
      std::vector<int> sums(bodies.solids);
      for (std::size_t t = 0; lattice.has_in_box(x) && t < bodies.solid_of.size(); ++t) {
        if (bodies.solid_of[t] == kNoSolid) continue;
        sums[bodies.solid_of[t]] +=
            winding_above(lattice, lattice.place_of(x), bodies.surface.at(t));
      }
      CHECK(parts.ref().contains(x) == std::ranges::any_of(sums, [](int sum) { return sum != 0; }));
    }
  }
}

TEST_CASE("places are pulled back where a pose has an inverse") {
  Random random(9);
  for (int i = 0; i < 200; ++i) {
    Pose pose = random_rotation(random, random_point(random, {{-1e6, -1e6, 0}, {1e6, 1e6, 100}}));
    const bool is_stretched = i % 2 == 1;
    if (is_stretched) pose = stretched(pose, {1.5, 0.5, -1});
    const Vec3 x = random_point(random, {{-5, -5, -5}, {5, 5, 5}});
    const Vec3 back = pulled_back(pose, transform(pose, x));
    CHECK(length_of(difference(back, x)) < 4e-9);
  }
  const Pose flat = stretched(Pose{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}}, {1, 1, 0});
  CHECK_FALSE(SolidLattice({{0, 0, 0}, {1, 1, 1}}).has_in_box(pulled_back(flat, {0.5, 0.5, 0})));
}
