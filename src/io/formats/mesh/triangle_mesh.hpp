#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "clearway/vec3.hpp"

namespace clearway {

/// Triangles over indexed vertices. Every index is that of a vertex, every coordinate is finite.
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
  std::string largest_bend_at;  ///< its place in the file
  std::uint64_t not_faces = 0;  ///< lines and single points that are drawn
  bool last_line_open = false;  ///< text that ends without a line break
};

/// A mesh file as it is read: no triangles where it holds vertices alone.
struct MeshFile {
  TriangleMesh mesh;
  MeshRemarks remarks;
};

}  // namespace clearway
