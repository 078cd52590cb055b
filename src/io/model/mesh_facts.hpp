#pragma once

#include <cstdint>

#include "io/formats/mesh/triangle_mesh.hpp"

namespace clearway {

/// Properties of a mesh. Vertices at the same place count as one. An edge is a pair of them; a
/// triangle with two corners at the same place has no edges.
struct MeshFacts {
  double area = 0;  ///< sum over the triangles, square metres
  std::uint64_t edges = 0;
  std::uint64_t open_edges = 0;     ///< edges of one triangle
  std::uint64_t crowded_edges = 0;  ///< edges of more than two triangles
  /// Edges of two triangles that run along them in the same direction.
  std::uint64_t flipped_edges = 0;
  std::uint64_t flat_triangles = 0;  ///< triangles without area
  std::uint64_t parts = 0;           ///< parts that share no vertex

  /// Whether every edge belongs to two triangles, once in each direction.
  bool watertight() const {
    return edges > 0 && open_edges == 0 && crowded_edges == 0 && flipped_edges == 0;
  }
};

MeshFacts facts_of(const TriangleMesh& mesh);

}  // namespace clearway
