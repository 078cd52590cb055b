#include "core/geometry/triangle.hpp"

#include <cmath>

#include "core/geometry/model_element.hpp"
#include "core/geometry/model_tree.hpp"
#include "core/geometry/triangle_packet.hpp"
#include "core/sweep/field/model_field.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/random_triangles.hpp"
#include "support/surface_scene.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

const Triangle kTriangle{{0, 0, 0}, {4, 0, 0}, {0, 3, 0}};

double bits_above(double value) { return std::nextafter(value, 1e9); }

}  // namespace

TEST_CASE("the distance to a triangle from each of its seven regions") {
  check_equal(squared_distance(Vec3{1, 1, 2}, kTriangle), 4);                 // face
  check_equal(squared_distance(Vec3{2, -1, 0}, kTriangle), 1);                // edge ab
  check_equal(squared_distance(Vec3{-1, 1, 0}, kTriangle), 1);                // edge ac
  CHECK(squared_distance(Vec3{2 + 3, 1.5 + 4, 0}, kTriangle) == Approx(25));  // edge bc
  check_equal(squared_distance(Vec3{-3, -4, 12}, kTriangle), 169);            // a
  check_equal(squared_distance(Vec3{7, -4, 0}, kTriangle), 25);               // b
  check_equal(squared_distance(Vec3{-3, 7, 12}, kTriangle), 169);             // c
}

TEST_CASE("a triangle collides strictly below the radius") {
  for (const Vec3& e : {Vec3{1, 1, 0.25}, Vec3{2, -0.25, 0}, Vec3{-0.25, 0, 0}}) {
    CHECK_FALSE(collides(e, kTriangle, 0.25));
    CHECK(collides(e, kTriangle, bits_above(0.25)));
  }
  CHECK_FALSE(collides(Vec3{1, 1, 0}, kTriangle, 0));  // not even for a point on the triangle
}

TEST_CASE("no triangle is farther than its corners as points") {
  for (std::uint64_t seed = 1; seed <= 3000; ++seed) {
    Random random(seed);
    const Triangle t = random_triangle(random);
    const Vec3 e = random_place_at(random, t);
    const double squared = squared_distance(e, t);
    for (const Vec3& corner : {t.a, t.b, t.c}) CHECK_FALSE(squared > squared_distance(e, corner));
  }
}

TEST_CASE("triangles without area are their edges and without length their corner") {
  const Vec3 a{1, 2, 3}, b{2, 2, 3}, e{1.5, 2.5, 3};
  check_equal(squared_distance(e, Triangle{a, b, b}), 0.25);
  check_equal(squared_distance(e, Triangle{b, a, a}), 0.25);
  check_equal(squared_distance(e, Triangle{a, a, b}), 0.25);
  check_equal(squared_distance(e, Triangle{a, Vec3{3, 2, 3}, b}), 0.25);
  check_equal(squared_distance(e, Triangle{a, a, a}), 0.5);
  // A triangle whose numbers underflow has no inside, and one whose numbers overflow decides
  // nothing.
  const Vec3 o{0, 0, 0};
  check_equal(squared_distance(Vec3{0, 1, 0}, Triangle{o, Vec3{1e-170, 0, 0}, Vec3{0, 0, 1e-170}}),
              1);
  CHECK_FALSE(collides(Vec3{0, 1, 0},
                       Triangle{Vec3{1e200, 0, 0}, Vec3{1e200, 1, 0}, Vec3{1e200, 0, 1}}, 5));
}

TEST_CASE("a triangle is moved corner by corner") {
  Random random(3);
  const Pose pose = random_rotation(random, {5e5, 5e6, 100});
  const Triangle moved = transform(pose, kTriangle);
  CHECK(moved == Triangle(transform(pose, kTriangle.a), transform(pose, kTriangle.b),
                          transform(pose, kTriangle.c)));
}

TEST_CASE("a box that collides with a triangle as a whole does so in every point") {
  std::uint64_t accepted = 0;
  for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
    Random random(seed);
    const Triangle t = random_triangle(random);
    const Vec3 centre = random_place_at(random, t);
    const double size = longest_edge(t) + 1e-9;
    const Vec3 half{size * uniform(random, 0, 1), size * uniform(random, 0, 1), 0};
    const Box box{plus(centre, -1, half), plus(centre, 1, half)};
    const double radius = std::sqrt(squared_distance(centre, t)) + size * uniform(random, 0, 3);
    if (!collides_with_all(box, t, radius, 1e-9 * size)) continue;
    ++accepted;
    for (int i = 0; i < 20; ++i) {
      CHECK(collides(random_point(random, box), t, radius));
    }
    for (int i = 0; i < 4; ++i) {
      const Vec3 corner{i & 1 ? box.lo.x : box.hi.x, i & 2 ? box.lo.y : box.hi.y, box.lo.z};
      CHECK(collides(corner, t, radius));
    }
  }
  CHECK(accepted > 100);
}

TEST_CASE("the field of a surface bounds the distance to it") {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    const double far = seed % 3 == 0 ? 1000 : 0;
    const Box part{{far - 1, -1, -0.5}, {far + 1, 1, 0.5}};
    const Surface surface =
        seed % 2 == 0 ? box_surface(part) : random_surface(random, part, 1 + below(random, 40));
    std::vector<Triangle> triangles;
    for (std::size_t i = 0; i < surface.triangles.size(); ++i) triangles.push_back(surface.at(i));
    const TriangleTree tree(triangles);
    const ModelField field(tree, 0.2, {.voxel = 0.15, .reach = 1}, 1);
    std::uint64_t wrong = 0;
    for (int i = 0; i < 2000; ++i) {
      // A quarter of the places lie on the surface itself, where the distance is all rounding.
      Vec3 x = random_point(random, {{far - 3, -3, -3}, {far + 3, 3, 3}});
      if (i % 4 == 0) x = random_place_at(random, triangles[below(random, triangles.size())]);
      double least = kInfinity;
      for (const Triangle& t : triangles) least = std::min(least, squared_distance(x, t));
      const ModelField::Bounds bounds = field.bounds(x);
      const double slack = 1024 * kUnitRoundoff * (3 + far);
      wrong += std::sqrt(bounds.squared_lower) > std::sqrt(least) + slack;
      wrong += bounds.near == ModelField::kNone;
      const TriangleTree::Nearest nearest =
          tree.nearest(x, static_cast<std::uint32_t>(i) % tree.size());
      wrong += std::abs(std::sqrt(nearest.squared_distance) - std::sqrt(least)) > slack;
    }
    check_equal(wrong, 0);
  }
}

// Distances to the triangles of a packet against the predicate, and bounds over hulls.
namespace {

constexpr int kPlaces = 60'000;

TrianglePacket packet_of(const Triangle& t) {
  TrianglePacket packet;
  packet.set(0, t, 7);
  packet.close(1);
  return packet;
}

double root_of(const Vec3& e, const Triangle& t) { return std::sqrt(squared_distance(e, t)); }

/// The bound on the difference between the predicate and a packet, of which each is within the
/// bound of its own.
double twice_error(const Triangle& t, double distance) {
  return 2.01 * triangle_error(distance, longest_edge(t));
}

double rounding_of(const Vec3& x) { return 4 * kUnitRoundoff * length_of(x); }

}  // namespace

TEST_CASE("a packet is as far from a place as the predicate says") {
  Random random(5);
  std::uint64_t wrong = 0, off_way = 0;
  for (int i = 0; i < kPlaces; ++i) {
    const Triangle t = random_triangle(random);
    const Vec3 x = random_place_at(random, t);
    const TrianglePacket packet = packet_of(t);
    const TrianglePacket::Nearest near = packet.nearest(TrianglePacket::kMost - 1, x);
    const double distance = root_of(x, t);
    wrong += !(std::abs(std::sqrt(near.squared) - distance) <= twice_error(t, distance));
    // The start of the way lies on the triangle.
    const Vec3 start = difference(x, near.way);
    off_way += !(root_of(start, t) <= twice_error(t, distance) + rounding_of(x));
  }
  check_equal(wrong, 0);
  check_equal(off_way, 0);
}

TEST_CASE("a packet has its last triangle in all lanes behind it") {
  Random random(4);
  const Triangle t = random_triangle(random), other = random_triangle(random);
  TrianglePacket packet;
  packet.set(0, t, 3);
  packet.set(1, other, 4);
  packet.close(2);
  check_equal(packet.count, 2);
  check_equal(packet.element(0), 3);
  for (std::uint32_t i = 1; i < TrianglePacket::kMost; ++i) {
    check_equal(packet.element(i), 4);
    CHECK(packet.nearest(i, t.a).squared == packet.nearest(1, t.a).squared);
  }
}

TEST_CASE("floats are as far from a place as the predicate says, within their slack") {
  Random random(8);
  std::uint64_t wrong = 0, loose = 0;
  for (int i = 0; i < kPlaces; ++i) {
    const Triangle t = random_triangle(random);
    const Vec3 x = random_place_at(random, t);
    const FloatPacket packet = FloatPacket::of(&t, 1, 7);
    const Vec3 seen = difference(x, packet.origin);
    const FloatVector place{static_cast<float>(seen.x), static_cast<float>(seen.y),
                            static_cast<float>(seen.z)};
    const double size = std::abs(seen.x) + std::abs(seen.y) + std::abs(seen.z);
    const auto slack = static_cast<double>(packet.slack(static_cast<float>(size)));
    const auto squared = static_cast<double>(packet.nearest(FloatPacket::kMost - 1, place).squared);
    const double distance = root_of(x, t);
    wrong += !(std::abs(std::sqrt(squared) - distance) <=
               slack + triangle_error(distance, longest_edge(t)) + rounding_of(x));
    loose += slack > 1e-4 * (size + longest_edge(t)) + 1e-16;
  }
  check_equal(wrong, 0);
  check_equal(loose, 0);
}

TEST_CASE("floats that may overflow have no bound, and those that vanish have one") {
  const auto slack = [](double size) {
    const Triangle t{{0, 0, 0}, {size, 0, 0}, {0, size, 0}};
    return FloatPacket::of(&t, 1, 0).slack(0);
  };
  CHECK(slack(1e16) == static_cast<float>(kInfinity));
  CHECK(slack(1e200) == static_cast<float>(kInfinity));
  CHECK(slack(1e14) < 1e11F);
  CHECK(slack(1e-60) >= 1e-17F);
}
