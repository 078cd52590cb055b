#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "clearway/query.hpp"
#include "io/formats/mesh/triangle_mesh.hpp"

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

/// A mesh divided into parts (docs/design/solids.md, "Parts"): triangles that share an edge belong
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

/// The parts of a mesh that must have a solid. Throws InputError, which names the faulty edges,
/// where it has none. name: the file's, for messages.
MeshParts parts_with_solids(const TriangleMesh& mesh, const std::string& name);

}  // namespace clearway
