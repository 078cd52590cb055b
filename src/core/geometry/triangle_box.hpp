#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/triangle.hpp"

namespace clearway {

/// Of indices into the vertices, all of which there are.
inline std::vector<Triangle> triangles_of(std::span<const Vec3> vertices,
                                          std::span<const std::array<std::uint32_t, 3>> indices) {
  std::vector<Triangle> triangles;
  triangles.reserve(indices.size());
  for (const auto& [a, b, c] : indices) {
    triangles.emplace_back(vertices[a], vertices[b], vertices[c]);
  }
  return triangles;
}

/// The box of triangles, at least one.
inline Box box_of(std::span<const Triangle> triangles) {
  Box box{triangles[0].a, triangles[0].a};
  for (const Triangle& t : triangles) {
    for (const Vec3* corner : {&t.a, &t.b, &t.c}) box.extend(*corner);
  }
  return box;
}

/// A lower bound: to the triangle's box.
inline double least_squared_distance(const Box& box, const Triangle& t) {
  return least_squared_distance(box, box_of(std::span<const Triangle>(&t, 1)));
}

/// By what elements are divided along an axis; for triangles three times their middle.
inline double place_along(const Vec3& m, int axis) { return m[axis]; }
inline double place_along(const Triangle& t, int axis) { return t.a[axis] + t.b[axis] + t.c[axis]; }

}  // namespace clearway
