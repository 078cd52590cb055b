#pragma once

#include <algorithm>
#include <span>

#include "core/geometry/box.hpp"

namespace clearway {

/// The box of points, at least one.
inline Box box_of(std::span<const Vec3> points) {
  Box box{points[0], points[0]};
  for (const Vec3& p : points) {
    for (int k = 0; k < 3; ++k) {
      box.lo[k] = std::min(box.lo[k], p[k]);
      box.hi[k] = std::max(box.hi[k], p[k]);
    }
  }
  return box;
}

/// The axis of the longest side, the first of equals.
inline int longest_side(const Box& box) {
  int longest = 0;
  for (int k = 1; k < 3; ++k) {
    if (box.hi[k] - box.lo[k] > box.hi[longest] - box.lo[longest]) longest = k;
  }
  return longest;
}

}  // namespace clearway
