#pragma once

#include <span>

#include "clearway/vec3.hpp"

namespace clearway {

static_assert(sizeof(Vec3) == 3 * sizeof(double));

/// The coordinates x, y, z of all points as one sequence, as the file stores them.
inline std::span<double> as_numbers(std::span<Vec3> points) {
  return {points.empty() ? nullptr : &points.front().x, 3 * points.size()};
}

inline std::span<const double> as_numbers(std::span<const Vec3> points) {
  return {points.empty() ? nullptr : &points.front().x, 3 * points.size()};
}

}  // namespace clearway
