#include "io/model/mesh_facts.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>

#include "core/geometry/predicate.hpp"
#include "io/formats/mesh/vertex_welder.hpp"

namespace clearway {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

struct Edge {
  std::uint32_t low, high;  ///< indices of the two vertices
  bool upwards;             ///< whether the edge runs from low to high

  friend bool operator<(const Edge& a, const Edge& b) {
    return std::tie(a.low, a.high, a.upwards) < std::tie(b.low, b.high, b.upwards);
  }
};

/// The triangles of the mesh with equal vertices joined, so that no two are at the same place.
Triangles welded(const TriangleMesh& mesh) {
  std::vector<Vec3> places;
  VertexWelder welder(places);
  std::vector<std::uint32_t> numbers;
  numbers.reserve(mesh.vertices.size());
  for (const Vec3& vertex : mesh.vertices) numbers.push_back(welder.number_of(vertex));
  Triangles triangles = mesh.triangles;
  for (auto& triangle : triangles) {
    for (std::uint32_t& corner : triangle) corner = numbers[corner];
  }
  return triangles;
}

double area_of(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 u = difference(b, a), v = difference(c, a);
  return std::hypot(u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x) / 2;
}

std::vector<Edge> edges_of(const Triangles& triangles) {
  std::vector<Edge> edges;
  for (const auto& [a, b, c] : triangles) {
    if (a == b || b == c || c == a) continue;
    for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
      edges.push_back({std::min(from, to), std::max(from, to), from < to});
    }
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

void count_edges(std::span<const Edge> edges, MeshFacts& facts) {
  for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
    while (end < edges.size() && edges[end].low == edges[begin].low &&
           edges[end].high == edges[begin].high) {
      ++end;
    }
    ++facts.edges;
    if (end - begin == 1) ++facts.open_edges;
    if (end - begin > 2) ++facts.crowded_edges;
    if (end - begin == 2 && edges[begin].upwards == edges[begin + 1].upwards) {
      ++facts.flipped_edges;
    }
  }
}

std::uint64_t count_parts(const Triangles& triangles, std::size_t vertices) {
  std::vector<std::uint32_t> root(vertices);
  std::iota(root.begin(), root.end(), 0u);
  const auto find = [&root](std::uint32_t v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  std::uint64_t parts = 0;
  std::vector<bool> seen(vertices);
  for (const auto& triangle : triangles) {
    for (const std::uint32_t corner : triangle) {
      if (!seen[corner]) ++parts;
      seen[corner] = true;
      const std::uint32_t a = find(corner), b = find(triangle[0]);
      if (a == b) continue;
      root[std::max(a, b)] = std::min(a, b);
      --parts;
    }
  }
  return parts;
}

}  // namespace

MeshFacts facts_of(const TriangleMesh& mesh) {
  MeshFacts facts;
  for (const auto& [a, b, c] : mesh.triangles) {
    const double area = area_of(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]);
    facts.area += area;
    if (!(area > 0)) ++facts.flat_triangles;
  }
  const Triangles triangles = welded(mesh);
  count_edges(edges_of(triangles), facts);
  facts.parts = count_parts(triangles, mesh.vertices.size());
  return facts;
}

}  // namespace clearway
