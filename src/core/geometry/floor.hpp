#pragma once

#include <limits>

#include "clearway/pose.hpp"
#include "clearway/vec3.hpp"
#include "core/geometry/inside.hpp"
#include "core/util/macros.hpp"

namespace clearway {

/// A floor below everything: every pair of a pose and a point counts.
inline constexpr double kNoFloor = -std::numeric_limits<double>::infinity();

/// Whether e counts at a pose: its height in the body's frame there is at least that of the floor.
/// This is the only place that decides it; everything faster is a filter
/// (docs/design/sweep.md).
CLEARWAY_HD inline bool is_above_floor(const Pose& pose, const Vec3& e, double floor) {
  return floor == kNoFloor || pulled_back(pose, e).z >= floor;
}

/// Whether e counts on the way from a pose to the next: at either end.
CLEARWAY_HD inline bool is_above_floor_on_way(const Pose& pose, const Pose& next, const Vec3& e,
                                              double floor) {
  return is_above_floor(pose, e, floor) || is_above_floor(next, e, floor);
}

}  // namespace clearway
