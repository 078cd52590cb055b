#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "clearway/query.hpp"
#include "io/formats/mesh/triangle_mesh.hpp"

namespace clearway {

/// What is wrong with an edge that keeps its part from being a solid.
enum class EdgeFault { kOpen, kCrowded, kSameWay };

inline constexpr std::array kEdgeFaults{EdgeFault::kOpen, EdgeFault::kCrowded, EdgeFault::kSameWay};

/// Edges with the same fault: how many, and the ends of the first few.
struct FaultyEdges {
  static constexpr std::size_t kMostShown = 3;

  std::uint64_t count = 0;
  std::vector<std::array<Vec3, 2>> first;  ///< at most kMostShown
};

/// A mesh by its parts (docs/design/solids.md, "Parts"): triangles that share an edge belong to
/// one.
struct MeshParts {
  /// No two vertices are at the same place, and no two triangles have the same corners in the same
  /// turn. In the order of the file.
  TriangleMesh mesh;
  std::vector<std::uint32_t> solid_of;  ///< per triangle its solid, or kNoSolid
  std::uint32_t solids = 0;             ///< numbered in the order of their first triangles
  std::uint64_t surface_parts = 0;      ///< parts that are no solid
  std::uint64_t surface_triangles = 0;
  std::uint64_t flat = 0;        ///< of these, with two equal corners; of no part
  std::uint64_t duplicates = 0;  ///< triangles left out
  std::array<FaultyEdges, kEdgeFaults.size()> faulty;  ///< by EdgeFault
};

MeshParts find_parts(const TriangleMesh& mesh);

/// One line: how many parts are solid, how many triangles are surface, what was left out.
std::string summary_of(const MeshParts& parts);

/// The edges that break the parts, with places; empty where none does.
std::string faults_of(const MeshParts& parts);

/// The parts of a mesh that has a solid. Throws InputError that names the edges where it has none.
/// name: of the file.
MeshParts parts_with_solids(const TriangleMesh& mesh, const std::string& name);

}  // namespace clearway
