#pragma once

#include <type_traits>

#include "core/geometry/box.hpp"
#include "core/geometry/inside.hpp"
#include "core/geometry/triangle.hpp"

/// The element that a model consists of: points (Vec3), triangles, or triangles some of which form
/// solids. Trees, bounds and the code of a search are templates over it.
namespace clearway {

template <typename Element>
inline constexpr bool kIsTriangle = std::is_base_of_v<Triangle, Element>;

template <typename Element>
inline constexpr bool kIsSolid = std::is_same_v<Element, SolidTriangle>;

/// The type that a model's tree holds for an element.
template <typename Element>
using StoredElement = std::conditional_t<kIsSolid<Element>, Triangle, Element>;

/// Whether the predicate says yes for every point of the box and a moved element. rounding: that of
/// a test of one point at one pose, metres.
CLEARWAY_HD inline bool collides_with_all(const Box& box, const Vec3& m, double radius,
                                          double /*rounding*/) {
  return greatest_squared_distance(box, m) < rounded_product(radius, radius);
}

/// Whether the predicate provably says yes for every point of the box and a triangle; false for
/// some boxes for which it does. The distance to a triangle is convex, so no place of a box is
/// farther than its farthest corner (docs/design/numerics.md, "Triangles").
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
