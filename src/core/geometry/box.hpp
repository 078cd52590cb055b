#pragma once

#include "clearway/box.hpp"
#include "core/geometry/predicate.hpp"

namespace clearway {

/// The largest |coordinate| of the box on each axis.
CLEARWAY_HD inline Vec3 reach_of(const Box& box) {
  Vec3 reach{};
  for (int k = 0; k < 3; ++k) reach[k] = box.hi[k] > -box.lo[k] ? box.hi[k] : -box.lo[k];
  return reach;
}

/// A value never above the predicate's d2 from m to any point e of the box, and equal to it for a
/// one-point box. No slack: every operation is the predicate's own and rounds monotonically
/// (docs/design/numerics.md, "Boxes").
CLEARWAY_HD inline double least_squared_distance(const Box& box, const Vec3& m) {
  double d[3];
  for (int k = 0; k < 3; ++k) {
    const double below = rounded_sum(box.lo[k], -m[k]);
    const double above = rounded_sum(m[k], -box.hi[k]);
    d[k] = below > 0 ? below : above > 0 ? above : 0.0;
  }
  return squared_length(d[0], d[1], d[2]);
}

/// A value never below the predicate's d2 from m to any point e of the box, by the same argument as
/// for least_squared_distance().
CLEARWAY_HD inline double greatest_squared_distance(const Box& box, const Vec3& m) {
  double d[3];
  for (int k = 0; k < 3; ++k) {
    const double to_lo = rounded_sum(m[k], -box.lo[k]);
    const double to_hi = rounded_sum(box.hi[k], -m[k]);
    d[k] = to_lo > to_hi ? to_lo : to_hi;
  }
  return squared_length(d[0], d[1], d[2]);
}

/// Squared distance between the nearest points of two boxes.
CLEARWAY_HD inline double least_squared_distance(const Box& a, const Box& b) {
  double d[3];
  for (int k = 0; k < 3; ++k) {
    const double below = b.lo[k] - a.hi[k], above = a.lo[k] - b.hi[k];
    d[k] = below > 0 ? below : above > 0 ? above : 0.0;
  }
  return squared_length(d[0], d[1], d[2]);
}

}  // namespace clearway
