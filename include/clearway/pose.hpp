#pragma once

#include "clearway/vec3.hpp"

namespace clearway {

/// A pose maps a model point m to rotation * m + translation. The rotation is kept as read, without
/// re-orthonormalising it. rotation: 3 x 3, row-major, unitless; translation: metres.
struct Pose {
  double rotation[9];
  double translation[3];
  friend bool operator==(const Pose&, const Pose&) = default;

  /// Position of the model's origin in the environment, metres.
  CLEARWAY_HD Vec3 position() const { return {translation[0], translation[1], translation[2]}; }

  /// Turns a direction of the model's frame into the environment's.
  CLEARWAY_HD Vec3 rotated(const Vec3& v) const {
    const double* r = rotation;
    return {r[0] * v.x + r[1] * v.y + r[2] * v.z, r[3] * v.x + r[4] * v.y + r[5] * v.z,
            r[6] * v.x + r[7] * v.y + r[8] * v.z};
  }

  /// Multiplies by the transposed rotation: turns a direction of the environment into the model's
  /// frame if the rotation is orthonormal.
  CLEARWAY_HD Vec3 rotated_back(const Vec3& v) const {
    const double* r = rotation;
    return {r[0] * v.x + r[3] * v.y + r[6] * v.z, r[1] * v.x + r[4] * v.y + r[7] * v.z,
            r[2] * v.x + r[5] * v.y + r[8] * v.z};
  }
};

}  // namespace clearway
