#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "io/models/mesh/mesh_builder.hpp"

namespace clearway::test {

inline Vec3 minus(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }

inline double distance(const Vec3& a, const Vec3& b) {
  const Vec3 d = minus(a, b);
  return std::sqrt(dot(d, d));
}

inline double segment_distance(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 way = minus(b, a);
  const double length = dot(way, way);
  const double t = length > 0 ? std::clamp(dot(minus(p, a), way) / length, 0.0, 1.0) : 0;
  return distance(p, {a.x + t * way.x, a.y + t * way.y, a.z + t * way.z});
}

/// The distance from p to a triangle: to its plane where p is above it, otherwise to its nearest
/// side.
inline double triangle_distance(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = cross(minus(b, a), minus(c, a));
  const double length = std::sqrt(dot(normal, normal));
  if (length > 0 && dot(cross(minus(b, a), minus(p, a)), normal) >= 0 &&
      dot(cross(minus(c, b), minus(p, b)), normal) >= 0 &&
      dot(cross(minus(a, c), minus(p, c)), normal) >= 0) {
    return std::abs(dot(minus(p, a), normal)) / length;
  }
  return std::min(
      {segment_distance(p, a, b), segment_distance(p, b, c), segment_distance(p, c, a)});
}

inline double surface_distance(const Vec3& p, const TriangleMesh& mesh) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [a, b, c] : mesh.triangles) {
    least =
        std::min(least, triangle_distance(p, mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]));
  }
  return least;
}

}  // namespace clearway::test
