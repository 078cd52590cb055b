#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "clearway/vec3.hpp"

namespace clearway {

/// Triangles over indexed vertices. Every index is that of a vertex, and every coordinate is
/// finite. A line segment from a to b is the triangle a, b, b, and a single point is a, a, a, so
/// that everything that works on triangles works on them too.
struct TriangleMesh {
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Counts of what was found in a mesh file, for remarks.
struct MeshRemarks {
  std::uint64_t polygons = 0;  ///< faces with more than three corners
  std::uint64_t crossing = 0;  ///< polygons whose outline crosses itself
  std::string first_crossing;  ///< position in the file of the first crossing polygon
  /// Greatest distance of a polygon's corner from the polygon's plane, in file units.
  double largest_bend = 0;
  std::string largest_bend_at;  ///< position in the file of the polygon with the largest bend
  std::uint64_t segments = 0;   ///< segments of lines in the file, which are triangles of the mesh
  std::uint64_t single_points = 0;  ///< single points in the file, which are triangles of the mesh
  bool last_line_open = false;      ///< whether the file is text that ends without a line break
};

/// A mesh file as read; it has no triangles where it holds vertices alone.
struct MeshFile {
  TriangleMesh mesh;
  MeshRemarks remarks;
};

}  // namespace clearway
