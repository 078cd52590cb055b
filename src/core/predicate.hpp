#pragma once

#include "core/macros.hpp"
#include "core/pose.hpp"
#include "core/vec3.hpp"

/// The one predicate of Clearway. Every engine's answer for a pair of an environment point and a
/// model point is decided here and nowhere else; everything faster is a filter that hands open
/// pairs to it. IEEE double, round to nearest, in the order written, never fused: on the device
/// by intrinsics, on the host by -ffp-contract=off on the interface of clearway_core.
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

/// (x x + y y) + z z
CLEARWAY_HD inline double squared_length(double x, double y, double z) {
  return rounded_sum(rounded_sum(rounded_product(x, x), rounded_product(y, y)),
                     rounded_product(z, z));
}

/// m' = ((R_k0 * m_0 + R_k1 * m_1) + R_k2 * m_2) + p_k for k = 0, 1, 2.
CLEARWAY_HD inline Vec3 transform(const Pose& pose, const Vec3& m) {
  Vec3 out;
  for (int k = 0; k < 3; ++k) {
    const double* row = pose.rotation + 3 * k;
    const double xy = rounded_sum(rounded_product(row[0], m.x), rounded_product(row[1], m.y));
    out[k] = rounded_sum(rounded_sum(xy, rounded_product(row[2], m.z)), pose.translation[k]);
  }
  return out;
}

/// d2 between an environment point and a transformed model point.
CLEARWAY_HD inline double squared_distance(const Vec3& e, const Vec3& m) {
  return squared_length(rounded_sum(e.x, -m.x), rounded_sum(e.y, -m.y), rounded_sum(e.z, -m.z));
}

/// True when environment point e collides with the transformed model point m: d2 < r * r, strict.
CLEARWAY_HD inline bool collides(const Vec3& e, const Vec3& m, double radius) {
  return squared_distance(e, m) < rounded_product(radius, radius);
}

}  // namespace clearway
