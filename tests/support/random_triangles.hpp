#pragma once

#include <algorithm>
#include <cmath>

#include "core/geometry/triangle.hpp"
#include "support/scenes.hpp"

/// Triangles of every kind, and places that are hard for them. Every test seeds its own generator.
namespace clearway::test {

inline Vec3 plus(const Vec3& a, double g, const Vec3& v) {
  return {a.x + g * v.x, a.y + g * v.y, a.z + g * v.z};
}

inline double length_of(const Vec3& v) { return std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z); }

inline double longest_edge(const Triangle& t) {
  return std::max({length_of(difference(t.b, t.a)), length_of(difference(t.c, t.a)),
                   length_of(difference(t.c, t.b))});
}

/// The bound of docs/design/numerics.md ("Triangles") on the error of the root of a computed d2.
inline double triangle_error(double distance, double longest) {
  return kUnitRoundoff * (8 * distance + 160 * longest) + 1e-150;
}

/// A random triangle: a needle, a sliver, one without area or length, of 1e-9 m to 1e6 m, near the
/// origin or far from it, with its corners in any order.
inline Triangle random_triangle(Random& random) {
  const double size = std::pow(10.0, uniform(random, -9, 6));
  const Vec3 along = random_direction(random), beside = random_direction(random);
  Vec3 a = random_point(random, {{-size, -size, -size}, {size, size, size}});
  if (below(random, 3) == 0) {
    for (int k = 0; k < 3; ++k) a[k] += (k == 2 ? 100 : k == 1 ? 5e6 : 5e5);
  }
  const double thin = below(random, 3) == 0 ? std::pow(10.0, uniform(random, -17, 0)) : 1;
  const double place =
      below(random, 4) == 0 ? uniform(random, -1e-12, 1e-12) : uniform(random, -1, 2);
  Triangle t{a, plus(a, size, along), plus(plus(a, place * size, along), thin * size, beside)};
  switch (below(random, 8)) {
    case 0:
      t.c = plus(t.a, uniform(random, 0, 1), difference(t.b, t.a));
      break;  // nearly collinear corners
    case 1:
      t.c = below(random, 2) == 0 ? t.a : t.b;
      break;
    case 2:
      t.c = {(t.a.x + t.b.x) / 2, (t.a.y + t.b.y) / 2, (t.a.z + t.b.z) / 2};
      break;
    default:
      break;
  }
  if (below(random, 20) == 0) t.b = t.c = t.a;
  switch (below(random, 6)) {
    case 0:
      return {t.b, t.c, t.a};
    case 1:
      return {t.c, t.a, t.b};
    case 2:
      return {t.b, t.a, t.c};
    case 3:
      return {t.a, t.c, t.b};
    case 4:
      return {t.c, t.b, t.a};
    default:
      return t;
  }
}

/// A random place on a corner, an edge, the face or beside it in the plane, moved away by 0 to 1000
/// times the longest edge.
inline Vec3 random_place_at(Random& random, const Triangle& t) {
  double b = uniform(random, -0.2, 1.2), c = uniform(random, -0.2, 1.2);
  switch (below(random, 6)) {
    case 0:
      b = c = 0;
      break;
    case 1:
      c = 0;
      break;
    case 2:
      c = 1 - b;
      break;
    case 3:
      b = uniform(random, 0, 1), c = uniform(random, 0, 1 - b);
      break;
    default:
      break;
  }
  const Vec3 on = plus(plus(t.a, b, difference(t.b, t.a)), c, difference(t.c, t.a));
  if (below(random, 4) == 0) return on;
  const double far = longest_edge(t) * std::pow(10.0, uniform(random, -16, 3)) + 1e-12;
  return plus(on, far, random_direction(random));
}

}  // namespace clearway::test
