#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "core/geometry/point_box.hpp"
#include "core/geometry/triangle.hpp"

/// What a model consists of: points (Vec3) or triangles. Trees, bounds and bodies of a search are
/// templates over one of them, the element.
namespace clearway {

template <typename Element>
inline constexpr bool kIsTriangle = std::is_same_v<Element, Triangle>;

inline std::vector<Triangle> triangles_of(std::span<const Vec3> vertices,
                                          std::span<const std::array<std::uint32_t, 3>> indices) {
  std::vector<Triangle> triangles;
  triangles.reserve(indices.size());
  for (const auto& [a, b, c] : indices) {
    triangles.push_back({vertices[a], vertices[b], vertices[c]});
  }
  return triangles;
}

/// The box of triangles, at least one.
inline Box box_of(std::span<const Triangle> triangles) {
  Box box{triangles[0].a, triangles[0].a};
  for (const Triangle& t : triangles) {
    for (const Vec3* corner : {&t.a, &t.b, &t.c}) {
      for (int k = 0; k < 3; ++k) {
        if ((*corner)[k] < box.lo[k]) box.lo[k] = (*corner)[k];
        if ((*corner)[k] > box.hi[k]) box.hi[k] = (*corner)[k];
      }
    }
  }
  return box;
}

/// By what elements are divided along an axis; for triangles three times their middle.
inline double place_along(const Vec3& m, int axis) { return m[axis]; }
inline double place_along(const Triangle& t, int axis) { return t.a[axis] + t.b[axis] + t.c[axis]; }

/// Whether the predicate says yes for every point of the box and a moved element. rounding: metres,
/// of a test of one point at one pose.
CLEARWAY_HD inline bool collides_with_all(const Box& box, const Vec3& m, double radius,
                                          double /*rounding*/) {
  return greatest_squared_distance(box, m) < rounded_product(radius, radius);
}

/// False for some boxes where it does. The distance to a triangle is convex, so no place of a box
/// is farther than its farthest corner (docs/design/numerics.md, "Triangles").
CLEARWAY_HD inline bool collides_with_all(const Box& box, const Triangle& t, double radius,
                                          double rounding) {
  const double most = (radius - rounding) * (1 - 64 * kUnitRoundoff);
  if (!(most > 0)) return false;
  for (int i = 0; i < 8; ++i) {
    const Vec3 corner{i & 1 ? box.hi.x : box.lo.x, i & 2 ? box.hi.y : box.lo.y,
                      i & 4 ? box.hi.z : box.lo.z};
    if (!(squared_distance(corner, t) < most * most)) return false;
  }
  return true;
}

}  // namespace clearway
