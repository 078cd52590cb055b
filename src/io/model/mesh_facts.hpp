#pragma once

#include <cstdint>

#include "io/formats/mesh/triangle_mesh.hpp"

namespace clearway {

/// What a mesh is like. Vertices at the same place count as one. An edge is a pair of them; a
/// triangle with two corners at the same place has no edges.
struct MeshFacts {
  double area = 0;  ///< the sum over the triangles, square metres
  std::uint64_t edges = 0;
  std::uint64_t open_edges = 0;      ///< of one triangle
  std::uint64_t crowded_edges = 0;   ///< of more than two
  std::uint64_t flipped_edges = 0;   ///< of two that run the same way along it
  std::uint64_t flat_triangles = 0;  ///< without area
  std::uint64_t parts = 0;           ///< that share no vertex

  /// Every edge is of two triangles, once in each direction.
  bool watertight() const {
    return edges > 0 && open_edges == 0 && crowded_edges == 0 && flipped_edges == 0;
  }
};

MeshFacts facts_of(const TriangleMesh& mesh);

}  // namespace clearway
