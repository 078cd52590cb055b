#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "clearway/query.hpp"
#include "io/models/mesh/mesh_builder.hpp"

namespace clearway {

/// The fault of an edge that keeps its part from being a solid.
enum class EdgeFault { kOpen, kCrowded, kSameWay };

inline constexpr std::array kEdgeFaults{EdgeFault::kOpen, EdgeFault::kCrowded, EdgeFault::kSameWay};

/// The edges with one fault: their number, and the ends of the first few.
struct FaultyEdges {
  static constexpr std::size_t kMostShown = 3;

  std::uint64_t count = 0;
  std::vector<std::array<Vec3, 2>> first;  ///< ends of the first edges, at most kMostShown
};

/// A mesh divided into parts (docs/design/model.md, "Parts"): triangles that share an edge belong
/// to the same part.
struct MeshParts {
  /// The mesh in the order of the file. No two vertices are at the same place, and no two triangles
  /// have the same corners in the same orientation.
  TriangleMesh mesh;
  std::vector<std::uint32_t> solid_of;  ///< the solid of each triangle, or kNoSolid
  /// Number of solids, which are numbered in the order of their first triangles.
  std::uint32_t solids = 0;
  std::uint64_t surface_parts = 0;  ///< number of parts that are not solids
  std::uint64_t surface_triangles = 0;
  std::uint64_t flat = 0;  ///< surface triangles with two equal corners, which belong to no part
  std::uint64_t duplicates = 0;  ///< number of duplicate triangles, which are left out
  std::array<FaultyEdges, kEdgeFaults.size()> faulty;  ///< faulty edges, by EdgeFault
};

MeshParts find_parts(const TriangleMesh& mesh);

/// A summary in one line: how many parts are solid, how many triangles are surface, and what was
/// left out.
std::string summary_of(const MeshParts& parts);

/// The faulty edges in words, with places; empty where there are none.
std::string faults_of(const MeshParts& parts);

/// Whether every part is closed, and there is one. Triangles without an area belong to no part, and
/// do not matter.
inline bool all_closed(const MeshParts& parts) {
  return parts.solids > 0 && parts.surface_parts == 0;
}

/// Why not all parts are closed, in words: the first edge that keeps one open.
std::string why_not_closed(const MeshParts& parts);

/// The parts of a mesh that must have a solid. Throws InputError, which names the faulty edges,
/// where it has none. name: the file's, for messages.
MeshParts parts_with_solids(const TriangleMesh& mesh, const std::string& name);

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
