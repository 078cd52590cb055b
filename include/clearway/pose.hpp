#pragma once

#include "clearway/vec3.hpp"

namespace clearway {

/// m' = rotation * m + translation, as read: the rotation is not re-orthonormalised.
/// rotation: 3 x 3, row-major, unitless; translation: metres.
struct Pose {
  double rotation[9];
  double translation[3];
  friend bool operator==(const Pose&, const Pose&) = default;

  /// Where the origin of the model's frame is.
  CLEARWAY_HD Vec3 position() const { return {translation[0], translation[1], translation[2]}; }

  /// A direction of the model's frame, in the environment's.
  CLEARWAY_HD Vec3 rotated(const Vec3& v) const {
    const double* r = rotation;
    return {r[0] * v.x + r[1] * v.y + r[2] * v.z, r[3] * v.x + r[4] * v.y + r[5] * v.z,
            r[6] * v.x + r[7] * v.y + r[8] * v.z};
  }

  /// The transposed rotation: a direction of the environment in the model's frame, where the
  /// rotation is orthonormal.
  CLEARWAY_HD Vec3 rotated_back(const Vec3& v) const {
    const double* r = rotation;
    return {r[0] * v.x + r[3] * v.y + r[6] * v.z, r[1] * v.x + r[4] * v.y + r[7] * v.z,
            r[2] * v.x + r[5] * v.y + r[8] * v.z};
  }
};

}  // namespace clearway
