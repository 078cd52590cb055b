#pragma once

#include "clearway/pose.hpp"
#include "clearway/vec3.hpp"
#include "core/util/macros.hpp"

/// The decision of the paper's GPU method: everything in float and in the scene's own coordinates.
/// Only for comparison; it is wrong near the radius, and more so far from the origin.
namespace clearway {

CLEARWAY_HD inline float float_product(float a, float b) {
#ifdef __CUDA_ARCH__
  return __fmul_rn(a, b);
#else
  return a * b;
#endif
}

CLEARWAY_HD inline float float_sum(float a, float b) {
#ifdef __CUDA_ARCH__
  return __fadd_rn(a, b);
#else
  return a + b;
#endif
}

/// Whether e collides with model point m at a pose in float arithmetic. All arguments are rounded
/// to float first; operations are never fused.
CLEARWAY_HD inline bool collides_in_float(const Vec3& e, const Pose& pose, const Vec3& m,
                                          double radius) {
  const float p[3] = {static_cast<float>(m.x), static_cast<float>(m.y), static_cast<float>(m.z)};
  float squares[3];
  for (int k = 0; k < 3; ++k) {
    const double* row = pose.rotation + 3 * k;
    const float xy = float_sum(float_product(static_cast<float>(row[0]), p[0]),
                               float_product(static_cast<float>(row[1]), p[1]));
    const float xyz = float_sum(xy, float_product(static_cast<float>(row[2]), p[2]));
    const float moved = float_sum(xyz, static_cast<float>(pose.translation[k]));
    const float d = float_sum(static_cast<float>(e[k]), -moved);
    squares[k] = float_product(d, d);
  }
  const auto r = static_cast<float>(radius);
  return float_sum(float_sum(squares[0], squares[1]), squares[2]) < float_product(r, r);
}

}  // namespace clearway
