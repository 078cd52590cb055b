#pragma once

#include "clearway/pose.hpp"
#include "clearway/vec3.hpp"
#include "core/util/macros.hpp"

/// The one predicate of Clearway. Every engine's answer for a pair of an environment point and a
/// model point is decided here and nowhere else; everything faster is a filter that hands open
/// pairs to it. IEEE double, round to nearest, in the order written, never fused: on the device
/// by intrinsics, on the host by -ffp-contract=off for all targets (cmake/options.cmake).
namespace clearway {

#ifdef __FAST_MATH__
#error "Clearway's answers are defined in strict IEEE arithmetic; build without -ffast-math"
#endif

CLEARWAY_HD inline double rounded_product(double a, double b) {
#ifdef __CUDA_ARCH__
  return __dmul_rn(a, b);
#else
  return a * b;
#endif
}

CLEARWAY_HD inline double rounded_sum(double a, double b) {
#ifdef __CUDA_ARCH__
  return __dadd_rn(a, b);
#else
  return a + b;
#endif
}

CLEARWAY_HD inline double rounded_quotient(double a, double b) {
#ifdef __CUDA_ARCH__
  return __ddiv_rn(a, b);
#else
  return a / b;
#endif
}

/// Dot product in this order of operations: (a_x b_x + a_y b_y) + a_z b_z.
CLEARWAY_HD inline double rounded_dot(const Vec3& a, const Vec3& b) {
  return rounded_sum(rounded_sum(rounded_product(a.x, b.x), rounded_product(a.y, b.y)),
                     rounded_product(a.z, b.z));
}

/// Squared length in this order of operations: (x x + y y) + z z.
CLEARWAY_HD inline double squared_length(double x, double y, double z) {
  return rounded_dot({x, y, z}, {x, y, z});
}

/// The vector a - b, each coordinate rounded once.
CLEARWAY_HD inline Vec3 difference(const Vec3& a, const Vec3& b) {
  return {rounded_sum(a.x, -b.x), rounded_sum(a.y, -b.y), rounded_sum(a.z, -b.z)};
}

/// Moves m by a pose: m' = ((R_k0 * m_0 + R_k1 * m_1) + R_k2 * m_2) + p_k for k = 0, 1, 2.
CLEARWAY_HD inline Vec3 transform(const Pose& pose, const Vec3& m) {
  Vec3 out;
  for (int k = 0; k < 3; ++k) {
    const double* row = pose.rotation + 3 * k;
    const double xy = rounded_sum(rounded_product(row[0], m.x), rounded_product(row[1], m.y));
    out[k] = rounded_sum(rounded_sum(xy, rounded_product(row[2], m.z)), pose.translation[k]);
  }
  return out;
}

/// The predicate's d2, the squared distance between an environment point and a transformed model
/// point.
CLEARWAY_HD inline double squared_distance(const Vec3& e, const Vec3& m) {
  const Vec3 d = difference(e, m);
  return rounded_dot(d, d);
}

/// True if environment point e collides with the transformed model point m: d2 < r * r, strict.
CLEARWAY_HD inline bool collides(const Vec3& e, const Vec3& m, double radius) {
  return squared_distance(e, m) < rounded_product(radius, radius);
}

/// True if e collides with the inside of the segment on which a model point moves from a, its place
/// at one pose, to b, its place at the next: 0 < n < D and w.w < r * r with n = ae.ab, D = ab.ab
/// and w = ae - (n / D) ab. False for a = b. collides() decides about the segment's ends.
CLEARWAY_HD inline bool collides_inside(const Vec3& e, const Vec3& a, const Vec3& b,
                                        double radius) {
  const Vec3 ab = difference(b, a);
  const Vec3 ae = difference(e, a);
  const double n = rounded_dot(ae, ab);
  const double length = rounded_dot(ab, ab);
  const double g = rounded_quotient(n, length);
  const Vec3 w = difference(
      ae, {rounded_product(g, ab.x), rounded_product(g, ab.y), rounded_product(g, ab.z)});
  const bool beside = (0 < n) & (n < length);
  return beside & (rounded_dot(w, w) < rounded_product(radius, radius));
}

/// True if e collides with a model point on its way from a to b, both ends included. Each end is
/// decided as at its pose, so a hit at a pose is a hit on the way to it and on the way from it.
CLEARWAY_HD inline bool collides_on_way(const Vec3& e, const Vec3& a, const Vec3& b,
                                        double radius) {
  const bool at_a = collides(e, a, radius);
  const bool inside = collides_inside(e, a, b, radius);
  const bool at_b = collides(e, b, radius);
  return at_a | inside | at_b;
}

}  // namespace clearway
