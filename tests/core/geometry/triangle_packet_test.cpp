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
  CHECK(wrong == 0);
  CHECK(loose == 0);
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
