#pragma once

#include "clearway/macros.hpp"

namespace clearway {

/// A position or a displacement, metres.
struct Vec3 {
  double x, y, z;

  CLEARWAY_HD double& operator[](int axis) { return axis == 0 ? x : axis == 1 ? y : z; }
  CLEARWAY_HD double operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
  friend bool operator==(const Vec3&, const Vec3&) = default;
};

}  // namespace clearway
