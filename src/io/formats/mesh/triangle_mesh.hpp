#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "clearway/vec3.hpp"

namespace clearway {

/// Triangles over indexed vertices. Every index is that of a vertex, every coordinate is finite. A
/// line segment from a to b is the triangle a, b, b, and a single point is a, a, a: everything that
/// is asked of triangles is asked of them too.
struct TriangleMesh {
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// What became of a file's faces, and what beside them was met.
struct MeshRemarks {
  std::uint64_t polygons = 0;  ///< faces with more than three corners
  std::uint64_t crossing = 0;  ///< of them, those whose outline crosses itself
  std::string first_crossing;  ///< its place in the file
  double largest_bend = 0;  ///< farthest corner of a polygon from the polygon's plane, file units
  std::string largest_bend_at;      ///< its place in the file
  std::uint64_t segments = 0;       ///< of lines that the file draws; triangles of the mesh
  std::uint64_t single_points = 0;  ///< that the file draws; triangles of the mesh
  bool last_line_open = false;      ///< text that ends without a line break
};

/// A mesh file as it is read: no triangles where it holds vertices alone.
struct MeshFile {
  TriangleMesh mesh;
  MeshRemarks remarks;
};

}  // namespace clearway
