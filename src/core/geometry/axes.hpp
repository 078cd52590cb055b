#pragma once

#include "clearway/axis.hpp"
#include "clearway/vec3.hpp"

namespace clearway {

/// The coordinate that an axis lies along: 0 for x, 1 for y and 2 for z.
inline int line_of(Axis axis) { return static_cast<int>(axis) / 2; }

inline bool is_negative(Axis axis) { return static_cast<int>(axis) % 2 != 0; }

/// Whether two axes lie along one line.
inline bool along_one_line(Axis a, Axis b) { return line_of(a) == line_of(b); }

/// The unit vector of an axis.
inline Vec3 direction_of(Axis axis) {
  Vec3 out{0, 0, 0};
  out[line_of(axis)] = is_negative(axis) ? -1 : 1;
  return out;
}

/// The axis to the left of one that points ahead and one that points up, which must not be
/// parallel.
inline Axis axis_to_left(const ModelAxes& axes) {
  const Vec3 left = cross(direction_of(axes.up), direction_of(axes.forward));
  const int line = 3 - line_of(axes.forward) - line_of(axes.up);
  return static_cast<Axis>(2 * line + (left[line] < 0 ? 1 : 0));
}

/// A place of a model with these axes in the frame with x ahead, y to the left and z up. This is
/// exact, because coordinates are only exchanged and their signs changed.
inline Vec3 turned(const Vec3& place, const ModelAxes& axes) {
  const auto along = [&place](Axis axis) {
    const double value = place[line_of(axis)];
    return is_negative(axis) ? -value : value;
  };
  return {along(axes.forward), along(axis_to_left(axes)), along(axes.up)};
}

}  // namespace clearway
