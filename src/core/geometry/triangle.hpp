#pragma once

#include "clearway/vec3.hpp"
#include "core/geometry/box.hpp"
#include "core/geometry/predicate.hpp"
#include "core/geometry/sweep_bounds.hpp"

/// The predicate for triangles: IEEE double in the order written, never fused, as for points. Its
/// error is bounded in docs/design/numerics.md ("Triangles").
namespace clearway {

/// The corners of a triangle, metres. None is refused: a triangle without area counts as its edges,
/// one without length as a point.
struct Triangle {
  Triangle() = default;
  /// Declared so that three numbers in braces are never taken for a triangle.
  CLEARWAY_HD Triangle(const Vec3& at_a, const Vec3& at_b, const Vec3& at_c)
      : a(at_a), b(at_b), c(at_c) {}

  Vec3 a, b, c;

  friend bool operator==(const Triangle&, const Triangle&) = default;
};

CLEARWAY_HD inline Triangle transform(const Pose& pose, const Triangle& t) {
  return {transform(pose, t.a), transform(pose, t.b), transform(pose, t.c)};
}

namespace triangle_detail {

/// The place a + g v, rounded after each operation.
CLEARWAY_HD inline Vec3 along(const Vec3& a, double g, const Vec3& v) {
  return {rounded_sum(a.x, rounded_product(g, v.x)), rounded_sum(a.y, rounded_product(g, v.y)),
          rounded_sum(a.z, rounded_product(g, v.z))};
}

/// Lowers `least` to the squared length of `place` if that is less; NaN changes nothing.
CLEARWAY_HD inline void lower(double& least, const Vec3& place) {
  const double squared = rounded_dot(place, place);
  if (squared < least) least = squared;
}

/// The foot of the origin on a line, at n / length of the vector v from a.
struct Foot {
  double n, length;

  CLEARWAY_HD Foot(const Vec3& a, const Vec3& v)
      : n(-rounded_dot(a, v)), length(rounded_dot(v, v)) {}

  CLEARWAY_HD double share() const { return rounded_quotient(n, length); }
  /// Strictly between both ends, because an end is decided as a corner.
  CLEARWAY_HD bool is_inside() const { return (0 < n) & (n < length); }
};

CLEARWAY_HD inline void lower_by_edge(double& least, const Vec3& a, const Vec3& v,
                                      const Foot& foot) {
  if (foot.is_inside()) lower(least, along(a, foot.share(), v));
}

/// Lowers `least` by the foot on the plane if it lies strictly within the triangle. on_ab: the foot
/// on line ab.
CLEARWAY_HD inline void lower_by_face(double& least, const Vec3& a, const Vec3& ab, const Vec3& ac,
                                      const Foot& on_ab) {
  const double t = on_ab.share();
  const double g = rounded_quotient(rounded_dot(ac, ab), on_ab.length);
  const Vec3 height = along(ac, -g, ab);
  const Foot foot(along(a, t, ab), height);
  const double of_c = foot.share();
  const double of_b = rounded_sum(t, -rounded_product(of_c, g));
  if ((0 < of_c) & (0 < of_b) & (rounded_sum(of_b, of_c) < 1)) {
    lower(least, along(along(a, of_b, ab), of_c, ac));
  }
}

}  // namespace triangle_detail

/// The predicate's d2 between e and a transformed triangle: the least squared length, seen from e,
/// of its corners, of the feet strictly within its edges, and of the foot strictly within its face.
/// Never more than squared_distance(e, corner).
CLEARWAY_HD inline double squared_distance(const Vec3& e, const Triangle& t) {
  using namespace triangle_detail;
  const Vec3 a = difference(t.a, e), b = difference(t.b, e), c = difference(t.c, e);
  double least = kInfinity;
  lower(least, a);
  lower(least, b);
  lower(least, c);
  const Vec3 ab = difference(b, a), ac = difference(c, a), bc = difference(c, b);
  const Foot on_ab(a, ab);
  lower_by_edge(least, a, ab, on_ab);
  lower_by_edge(least, a, ac, Foot(a, ac));
  lower_by_edge(least, b, bc, Foot(b, bc));
  lower_by_face(least, a, ab, ac, on_ab);
  return least;
}

/// True if environment point e collides with the transformed triangle: d2 < r * r, strict.
CLEARWAY_HD inline bool collides(const Vec3& e, const Triangle& t, double radius) {
  return squared_distance(e, t) < rounded_product(radius, radius);
}

}  // namespace clearway
