#pragma once

#include <span>
#include <vector>

#include "clearway/model.hpp"
#include "core/geometry/triangle.hpp"

namespace clearway {

/// The triangles of a model. Their indices must be below the number of its vertices.
inline std::vector<Triangle> triangles_of(const Model& model) {
  std::vector<Triangle> triangles;
  triangles.reserve(model.triangles.size());
  for (const auto& [a, b, c] : model.triangles) {
    triangles.emplace_back(model.vertices[a], model.vertices[b], model.vertices[c]);
  }
  return triangles;
}

/// The box around triangles, of which there must be at least one.
inline Box box_of(std::span<const Triangle> triangles) {
  Box box{triangles[0].a, triangles[0].a};
  for (const Triangle& t : triangles) {
    for (const Vec3* corner : {&t.a, &t.b, &t.c}) box.extend(*corner);
  }
  return box;
}

/// Lower bound on the squared distance between a box and a triangle: that to the triangle's box.
inline double least_squared_distance(const Box& box, const Triangle& t) {
  return least_squared_distance(box, box_of(std::span<const Triangle>(&t, 1)));
}

/// The coordinate by which elements are divided along an axis; for triangles three times that of
/// their centroid.
inline double place_along(const Vec3& m, int axis) { return m[axis]; }
inline double place_along(const Triangle& t, int axis) { return t.a[axis] + t.b[axis] + t.c[axis]; }

}  // namespace clearway
