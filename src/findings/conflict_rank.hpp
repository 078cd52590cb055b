#pragma once

#include <algorithm>
#include <limits>

#include "clearway/conflicts.hpp"

namespace clearway {

/// Distances below this, in metres, say only that the surfaces touch, because a scan can show no
/// more. Which of two such distances is smaller by a tenth of a millimetre does not matter for the
/// rank.
inline constexpr double kTouching = 0.001;

/// The distance by which a conflict is ranked; infinity where none is known.
inline double ranked_distance(const Conflict& c) {
  const double distance = c.least_distance.value_or(std::numeric_limits<double>::infinity());
  return distance >= 0 && distance < kTouching ? 0 : distance;
}

/// The shorter of the shifts to the left and to the right that free the conflict. Infinity where
/// neither side frees it, and 0 where no shifts are known.
inline double ranked_shift(const Conflict& c, bool shifts_known) {
  if (!shifts_known) return 0;
  const double none = std::numeric_limits<double>::infinity();
  return std::min(c.shift_left.value_or(none), c.shift_right.value_or(none));
}

/// Whether a is worse than b: deeper or nearer, then harder to free by a shift, then of more
/// points, then earlier along the path. shifts_known: whether any of the conflicts has a shift.
inline bool is_worse(const Conflict& a, const Conflict& b, bool shifts_known) {
  const double near_a = ranked_distance(a), near_b = ranked_distance(b);
  if (near_a != near_b) return near_a < near_b;
  const double shift_a = ranked_shift(a, shifts_known), shift_b = ranked_shift(b, shifts_known);
  if (shift_a != shift_b) return shift_a > shift_b;
  if (a.points != b.points) return a.points > b.points;
  return a.id < b.id;
}

inline bool has_shifts(const Conflicts& conflicts) {
  return std::ranges::any_of(conflicts.listed, [](const Conflict& c) {
    return c.shift_left.has_value() || c.shift_right.has_value();
  });
}

}  // namespace clearway
