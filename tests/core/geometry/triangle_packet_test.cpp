// Distances to the triangles of a packet against the predicate, and bounds over hulls.
#include "core/geometry/triangle_packet.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "support/random_triangles.hpp"

using namespace clearway;
using namespace clearway::test;

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
  CHECK(wrong == 0);
  CHECK(off_way == 0);
}

TEST_CASE("a packet has its last triangle in all lanes behind it") {
  Random random(4);
  const Triangle t = random_triangle(random), other = random_triangle(random);
  TrianglePacket packet;
  packet.set(0, t, 3);
  packet.set(1, other, 4);
  packet.close(2);
  CHECK(packet.count == 2);
  CHECK(packet.element(0) == 3);
  for (std::uint32_t i = 1; i < TrianglePacket::kMost; ++i) {
    CHECK(packet.element(i) == 4);
    CHECK(packet.nearest(i, t.a).squared == packet.nearest(1, t.a).squared);
  }
}

TEST_CASE("the bound of a hull is below the distance of every place of it") {
  Random random(6);
  std::uint64_t above = 0, close = 0, clear = 0;
  for (int i = 0; i < kPlaces; ++i) {
    const Triangle t = random_triangle(random);
    const Vec3 x = random_place_at(random, t);
    const double far = longest_edge(t) * std::pow(10.0, uniform(random, -8, 2));
    const Vec3 y = plus(x, far, random_direction(random));
    const Vec3 way = difference(y, x);
    const TrianglePacket packet = packet_of(t);
    const TrianglePacket::Nearest near = packet.nearest(0, x);
    // Every direction gives a bound; the direction of the shortest way gives a close one.
    const bool shortest = below(random, 3) != 0;
    const Vec3 across =
        shortest ? near.way : plus({}, length_of(near.way), random_direction(random));
    const double along = std::min(0.0, TrianglePacket::dot(across, way)) -
                         4 * kUnitRoundoff * length_of(across) * length_of(way);
    const double bound = std::sqrt(packet.from_hull(0, x, near.squared, across, along));
    double least = root_of(x, t);
    for (const double g : {0.01, 0.3, 0.7, 1.0, uniform(random, 0, 1)}) {
      const Vec3 place = plus(x, g, way);
      const double distance = root_of(place, t);
      above += !(bound <= distance + twice_error(t, distance) + rounding_of(x) + rounding_of(way));
      least = std::min(least, distance);
    }
    const bool is_clear =
        shortest && TrianglePacket::dot(across, way) >= 0 && least > 0.01 * longest_edge(t);
    clear += is_clear;
    close += is_clear && bound > 0.98 * least;
  }
  CHECK(above == 0);
  CHECK(clear > 1000);
  CHECK(close == clear);
}
