#pragma once

#include <cstdint>
#include <cstring>
#include <string>

#include "io/models/mesh/mesh_builder.hpp"

namespace clearway::test {

/// The cube from 0 to 1: 8 vertices, and 12 triangles that are counter-clockwise seen from outside.
inline TriangleMesh unit_cube() {
  constexpr std::uint32_t kSides[][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                         {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  TriangleMesh cube{
      {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}, {}};
  for (const auto& [a, b, c, d] : kSides) {
    cube.triangles.insert(cube.triangles.end(), {{a, b, c}, {a, c, d}});
  }
  return cube;
}

inline std::string words(const Vec3& v) {
  return std::to_string(v.x) + " " + std::to_string(v.y) + " " + std::to_string(v.z);
}

/// The mesh as text STL.
inline std::string ascii_stl(const TriangleMesh& mesh) {
  std::string text = "solid made\n";
  for (const auto& triangle : mesh.triangles) {
    text += " facet normal 0 0 0\n  outer loop\n";
    for (const std::uint32_t v : triangle) text += "   vertex " + words(mesh.vertices[v]) + "\n";
    text += "  endloop\n endfacet\n";
  }
  return text + "endsolid made\n";
}

template <typename Value>
void put(std::string& bytes, Value value) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  bytes.append(raw, sizeof value);
}

/// The mesh as binary STL whose header starts with `header`.
inline std::string binary_stl(const TriangleMesh& mesh, std::string header = "made") {
  std::string bytes = std::move(header);
  bytes.resize(80, ' ');
  put(bytes, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& triangle : mesh.triangles) {
    bytes.append(12, '\0');
    for (const std::uint32_t v : triangle) {
      for (int k = 0; k < 3; ++k) put(bytes, static_cast<float>(mesh.vertices[v][k]));
    }
    bytes.append(2, '\0');
  }
  return bytes;
}

/// A line for each vertex and for each triangle, whose first vertex has the number `first`.
inline std::string lines_of(const TriangleMesh& mesh, const std::string& vertex,
                            const std::string& triangle, std::uint32_t first) {
  std::string text;
  for (const Vec3& v : mesh.vertices) text += vertex + words(v) + "\n";
  for (const auto& corners : mesh.triangles) {
    text += triangle;
    for (const std::uint32_t corner : corners) text += " " + std::to_string(corner + first);
    text += "\n";
  }
  return text;
}

inline std::string obj_text(const TriangleMesh& mesh) { return lines_of(mesh, "v ", "f", 1); }

inline std::string off_text(const TriangleMesh& mesh) {
  return "OFF\n" + std::to_string(mesh.vertices.size()) + " " +
         std::to_string(mesh.triangles.size()) + " 0\n" + lines_of(mesh, "", "3", 0);
}

/// The mesh as PLY. format: "ascii" or "binary_little_endian".
inline std::string ply_mesh(const TriangleMesh& mesh, const std::string& format) {
  std::string bytes = "ply\nformat " + format + " 1.0\nelement vertex " +
                      std::to_string(mesh.vertices.size()) +
                      "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
                      std::to_string(mesh.triangles.size()) +
                      "\nproperty list uchar int vertex_indices\nend_header\n";
  if (format == "ascii") return bytes + lines_of(mesh, "", "3", 0);
  for (const Vec3& v : mesh.vertices) {
    for (int k = 0; k < 3; ++k) put(bytes, v[k]);
  }
  for (const auto& triangle : mesh.triangles) {
    bytes += '\3';
    for (const std::uint32_t v : triangle) put(bytes, v);
  }
  return bytes;
}

}  // namespace clearway::test
