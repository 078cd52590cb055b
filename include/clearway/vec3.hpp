#pragma once

#include <cmath>

#include "clearway/macros.hpp"

namespace clearway {

/// A position or a displacement, metres.
struct Vec3 {
  double x, y, z;

  CLEARWAY_HD double& operator[](int axis) { return axis == 0 ? x : axis == 1 ? y : z; }
  CLEARWAY_HD double operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
  friend bool operator==(const Vec3&, const Vec3&) = default;

  // Everyday arithmetic, for places that decide no collision: a compiler for a GPU may fuse a
  // product and a sum of it. The predicate has its own operations, which are never fused.
  CLEARWAY_HD friend Vec3 operator+(const Vec3& a, const Vec3& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  CLEARWAY_HD friend Vec3 operator-(const Vec3& a, const Vec3& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  CLEARWAY_HD friend Vec3 operator*(double factor, const Vec3& v) {
    return {factor * v.x, factor * v.y, factor * v.z};
  }
};

CLEARWAY_HD inline double dot(const Vec3& a, const Vec3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// The vector at a right angle to both, by the right-hand rule.
CLEARWAY_HD inline Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

CLEARWAY_HD inline double length(const Vec3& v) { return std::sqrt(dot(v, v)); }

}  // namespace clearway
