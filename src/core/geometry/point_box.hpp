#pragma once

#include <cmath>
#include <span>

#include "core/geometry/box.hpp"

namespace clearway {

/// The box around points, of which there must be at least one.
inline Box box_of(std::span<const Vec3> points) {
  Box box{points[0], points[0]};
  for (const Vec3& p : points) box.extend(p);
  return box;
}

/// The axis-aligned box around a box of the model's frame at a pose, up to roundings.
inline Box moved(const Box& box, const Pose& pose) {
  const Vec3 centre = transform(pose, box.centre());
  Box out{centre, centre};
  for (int k = 0; k < 3; ++k) {
    double half = 0;
    for (int j = 0; j < 3; ++j) {
      half += std::abs(pose.rotation[3 * k + j]) * (box.hi[j] - box.lo[j]) / 2;
    }
    out.lo[k] -= half;
    out.hi[k] += half;
  }
  return out;
}

}  // namespace clearway
