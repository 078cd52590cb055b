#include "core/geometry/triangle.hpp"

#include <cmath>

#include "core/geometry/model_element.hpp"
#include "core/geometry/triangle_packet.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/random_triangles.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

const Triangle kTriangle{{0, 0, 0}, {4, 0, 0}, {0, 3, 0}};

double root_of(const Vec3& e, const Triangle& t) { return std::sqrt(squared_distance(e, t)); }

}  // namespace

TEST_CASE("the distance to a triangle from each of its regions, and to one without an inside") {
  struct Row {
    const char* name;
    Vec3 e;
    Triangle t;
    double squared;
  };
  const Vec3 o{0, 0, 0}, a{1, 2, 3}, b{2, 2, 3}, above{1.5, 2.5, 3};
  const Row rows[] = {
      {"face", {1, 1, 2}, kTriangle, 4},
      {"edge ab", {2, -1, 0}, kTriangle, 1},
      {"edge ac", {-1, 1, 0}, kTriangle, 1},
      {"edge bc", {5, 5.5, 0}, kTriangle, 25},
      {"corner a", {-3, -4, 12}, kTriangle, 169},
      {"corner b", {7, -4, 0}, kTriangle, 25},
      {"corner c", {-3, 7, 12}, kTriangle, 169},
      {"b = c", above, {a, b, b}, 0.25},
      {"b = c, turned", above, {b, a, a}, 0.25},
      {"a = b", above, {a, a, b}, 0.25},
      {"corners on a line", above, {a, {3, 2, 3}, b}, 0.25},
      {"one place", above, {a, a, a}, 0.5},
      {"numbers that underflow", {0, 1, 0}, {o, {1e-170, 0, 0}, {0, 0, 1e-170}}, 1},
  };
  for (const Row& row : rows) {
    const RowName name(row.name);
    check_near(squared_distance(row.e, row.t), row.squared, 1e-14);
  }
  // Numbers that overflow decide nothing.
  CHECK_FALSE(collides(Vec3{0, 1, 0}, {{1e200, 0, 0}, {1e200, 1, 0}, {1e200, 0, 1}}, 5));
}

TEST_CASE("a triangle collides strictly below the radius") {
  for (const Vec3& e : {Vec3{1, 1, 0.25}, Vec3{2, -0.25, 0}, Vec3{-0.25, 0, 0}}) {
    CHECK_FALSE(collides(e, kTriangle, 0.25));
    CHECK(collides(e, kTriangle, std::nextafter(0.25, 1)));
  }
  CHECK_FALSE(collides(Vec3{1, 1, 0}, kTriangle, 0));  // not even for a point on the triangle
}

TEST_CASE("a triangle is moved corner by corner") {
  Random random(3);
  const Pose pose = random_rotation(random, {5e5, 5e6, 100});
  CHECK(transform(pose, kTriangle) == Triangle(transform(pose, kTriangle.a),
                                               transform(pose, kTriangle.b),
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
    const double radius = root_of(centre, t) + size * uniform(random, 0, 3);
    if (!collides_with_all(box, t, radius, 1e-9 * size)) continue;
    ++accepted;
    for (int i = 0; i < 24; ++i) {
      const Vec3 corner{i & 1 ? box.lo.x : box.hi.x, i & 2 ? box.lo.y : box.hi.y, box.lo.z};
      CHECK(collides(i < 4 ? corner : random_point(random, box), t, radius));
    }
  }
  CHECK(accepted > 100);
}

TEST_CASE("packets of triangles, of doubles and of floats, are as far as the predicate says") {
  Random random(5);
  std::uint64_t beyond_corners = 0, wrong = 0, off_way = 0, wrong_floats = 0, loose = 0;
  for (int i = 0; i < 60'000; ++i) {
    const Triangle t = random_triangle(random);
    const Vec3 x = random_place_at(random, t);
    const double distance = root_of(x, t);
    // The bound on the difference between the predicate and a packet, of which each is within the
    // bound of its own, and that of the coordinates.
    const double twice = 2.01 * triangle_error(distance, longest_edge(t));
    const double rounding = 4 * kUnitRoundoff * length_of(x);
    for (const Vec3& corner : {t.a, t.b, t.c}) {
      beyond_corners += squared_distance(x, t) > squared_distance(x, corner);
    }

    TrianglePacket packet;
    packet.set(0, t, 7);
    packet.close(1);
    const TrianglePacket::Nearest near = packet.nearest(TrianglePacket::kMost - 1, x);
    wrong += !(std::abs(std::sqrt(near.squared) - distance) <= twice);
    // The start of the way lies on the triangle.
    off_way += !(root_of(difference(x, near.way), t) <= twice + rounding);

    const FloatPacket floats = FloatPacket::of(&t, 1, 7);
    const Vec3 seen = difference(x, floats.origin);
    const double size = std::abs(seen.x) + std::abs(seen.y) + std::abs(seen.z);
    const auto slack = static_cast<double>(floats.slack(static_cast<float>(size)));
    const FloatVector place{static_cast<float>(seen.x), static_cast<float>(seen.y),
                            static_cast<float>(seen.z)};
    const auto squared = static_cast<double>(floats.nearest(FloatPacket::kMost - 1, place).squared);
    wrong_floats += !(std::abs(std::sqrt(squared) - distance) <= slack + twice / 2 + rounding);
    loose += slack > 1e-4 * (size + longest_edge(t)) + 1e-16;
  }
  check_equal(std::vector{beyond_corners, wrong, off_way, wrong_floats, loose},
              std::vector<std::uint64_t>(5, 0));
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
