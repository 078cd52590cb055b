#pragma once

#include "clearway/pose.hpp"
#include "clearway/vec3.hpp"

namespace clearway::scene {

/// Small turns away from a direction of travel, in radians and to first order: to the left, nose
/// up, left side up.
struct Attitude {
  double yaw = 0, pitch = 0, roll = 0;
};

/// The pose of a model whose x axis points along `forward` (not upright), as upright as it can be
/// but for the attitude. Orthonormal to rounding.
Pose pose_along(const Vec3& position, const Vec3& forward, const Attitude& attitude);

}  // namespace clearway::scene
