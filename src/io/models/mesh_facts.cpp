#include "io/models/mesh_facts.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>

#include "core/geometry/predicate.hpp"
#include "core/util/disjoint_sets.hpp"
#include "core/util/format.hpp"
#include "io/files/input_error.hpp"
#include "io/models/mesh/mesh_builder.hpp"

namespace clearway {
namespace {

using Corners = std::array<std::uint32_t, 3>;

/// One triangle's use of an edge between two vertices.
struct EdgeUse {
  std::uint32_t low, high;  ///< indices of the two vertices
  std::uint32_t triangle;
  bool upwards;  ///< whether the triangle runs from low to high

  auto ends() const { return std::tie(low, high); }
};

bool is_flat(const Corners& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

/// The corners rotated so that the least comes first, which gives the same for all triangles with
/// these corners in this orientation.
Corners turned_to_least(Corners t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

TriangleMesh merged(const TriangleMesh& mesh) {
  TriangleMesh out;
  VertexWelder welder(out.vertices);
  std::vector<std::uint32_t> numbers;
  numbers.reserve(mesh.vertices.size());
  for (const Vec3& vertex : mesh.vertices) numbers.push_back(welder.number_of(vertex));
  out.triangles = mesh.triangles;
  for (Corners& triangle : out.triangles) {
    for (std::uint32_t& corner : triangle) corner = numbers[corner];
  }
  return out;
}

/// Keeps the first of equal triangles and returns how many others are left out.
std::uint64_t leave_out_duplicates(std::vector<Corners>& triangles) {
  std::vector<std::pair<Corners, std::uint32_t>> sorted;
  sorted.reserve(triangles.size());
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    sorted.emplace_back(turned_to_least(triangles[i]), i);
  }
  std::sort(sorted.begin(), sorted.end());
  std::vector<bool> is_left_out(triangles.size());
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    if (sorted[i].first == sorted[i - 1].first) is_left_out[sorted[i].second] = true;
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (!is_left_out[i]) triangles[kept++] = triangles[i];
  }
  const std::uint64_t left_out = triangles.size() - kept;
  triangles.resize(kept);
  return left_out;
}

std::vector<EdgeUse> edge_uses(const std::vector<Corners>& triangles) {
  std::vector<EdgeUse> uses;
  uses.reserve(3 * triangles.size());
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    const auto& [a, b, c] = triangles[i];
    if (is_flat(triangles[i])) continue;
    for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
      uses.push_back({std::min(from, to), std::max(from, to), i, from < to});
    }
  }
  std::sort(uses.begin(), uses.end(), [](const EdgeUse& a, const EdgeUse& b) {
    return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
  });
  return uses;
}

/// Calls visit(uses of one edge) for every edge. The uses must be sorted by edge.
template <typename Visit>
void for_each_edge(std::span<const EdgeUse> uses, Visit visit) {
  for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
    while (end < uses.size() && uses[end].ends() == uses[begin].ends()) ++end;
    visit(uses.subspan(begin, end - begin));
  }
}

/// Whether an edge keeps its part from being a solid; if so, `fault` is how.
bool is_faulty(std::span<const EdgeUse> edge, EdgeFault& fault) {
  fault = edge.size() == 1  ? EdgeFault::kOpen
          : edge.size() > 2 ? EdgeFault::kCrowded
                            : EdgeFault::kSameWay;
  return edge.size() != 2 || edge[0].upwards == edge[1].upwards;
}

void note(FaultyEdges& edges, const Vec3& from, const Vec3& to) {
  ++edges.count;
  if (edges.first.size() < FaultyEdges::kMostShown) edges.first.push_back({from, to});
}

/// Least number of triangles of a solid; with fewer, a closed part encloses nothing.
constexpr std::uint32_t kLeastOfSolid = 4;

/// Numbers the solids. faulty: whether a part has a faulty edge, by the part's first triangle.
void number_solids(DisjointSets& finder, const std::vector<bool>& faulty, MeshParts& parts) {
  const auto count = static_cast<std::uint32_t>(parts.mesh.triangles.size());
  std::vector<std::uint32_t> size_of(count), number_of(count, kNoSolid);
  for (std::uint32_t i = 0; i < count; ++i) {
    if (!is_flat(parts.mesh.triangles[i])) ++size_of[finder.root(i)];
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    if (size_of[i] >= kLeastOfSolid && !faulty[i]) {
      number_of[i] = parts.solids++;
    } else {
      parts.surface_parts += size_of[i] > 0 ? 1 : 0;
    }
  }
  parts.solid_of.resize(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const bool flat = is_flat(parts.mesh.triangles[i]);
    parts.solid_of[i] = flat ? kNoSolid : number_of[finder.root(i)];
    parts.flat += flat ? 1 : 0;
    parts.surface_triangles += parts.solid_of[i] == kNoSolid ? 1 : 0;
  }
}

std::string shown_place(const Vec3& p) {
  return "(" + format_number(p.x) + ", " + format_number(p.y) + ", " + format_number(p.z) + ")";
}

const char* words_for(EdgeFault fault) {
  switch (fault) {
    case EdgeFault::kOpen:
      return "of one triangle only (an open border)";
    case EdgeFault::kCrowded:
      return "of more than two triangles";
    case EdgeFault::kSameWay:
      return "of two triangles that run the same way along it";
  }
  return "";
}

}  // namespace

MeshParts find_parts(const TriangleMesh& mesh) {
  MeshParts parts;
  parts.mesh = merged(mesh);
  parts.duplicates = leave_out_duplicates(parts.mesh.triangles);
  const std::vector<EdgeUse> uses = edge_uses(parts.mesh.triangles);
  DisjointSets finder(parts.mesh.triangles.size());
  for_each_edge(uses, [&](std::span<const EdgeUse> edge) {
    for (const EdgeUse& use : edge) finder.join(edge[0].triangle, use.triangle);
  });
  std::vector<bool> faulty(parts.mesh.triangles.size());
  for_each_edge(uses, [&](std::span<const EdgeUse> edge) {
    EdgeFault fault{};
    if (!is_faulty(edge, fault)) return;
    faulty[finder.root(edge[0].triangle)] = true;
    const auto& vertices = parts.mesh.vertices;
    note(parts.faulty[static_cast<std::size_t>(fault)], vertices[edge[0].low],
         vertices[edge[0].high]);
  });
  number_solids(finder, faulty, parts);
  return parts;
}

std::string summary_of(const MeshParts& parts) {
  const std::uint64_t of_solids = parts.mesh.triangles.size() - parts.surface_triangles;
  std::string text = format_count(parts.solids) + " closed parts of " + format_count(of_solids) +
                     " triangles are solid; " + format_count(parts.surface_triangles) +
                     " other triangles are surface, in " + format_count(parts.surface_parts) +
                     " open parts";
  if (parts.flat > 0) {
    text += "; " + format_count(parts.flat) +
            " of them have two equal corners, as line segments and single points have";
  }
  if (parts.duplicates > 0) {
    text += "; " + format_count(parts.duplicates) + " that occur twice are left out";
  }
  return text;
}

std::string faults_of(const MeshParts& parts) {
  std::string text;
  for (const EdgeFault fault : kEdgeFaults) {
    const FaultyEdges& edges = parts.faulty[static_cast<std::size_t>(fault)];
    if (edges.count == 0) continue;
    if (!text.empty()) text += "; ";
    text += format_count(edges.count) + (edges.count == 1 ? " edge is " : " edges are each ") +
            words_for(fault) + ", ";
    text += edges.count > 1 ? "the first from " : "from ";
    for (std::size_t i = 0; i < edges.first.size(); ++i) {
      if (i > 0) text += ", from ";
      text += shown_place(edges.first[i][0]) + " to " + shown_place(edges.first[i][1]);
    }
  }
  return text;
}

std::string why_not_closed(const MeshParts& parts) {
  const std::uint64_t all = parts.solids + parts.surface_parts;
  if (all == 0) return "it encloses nothing";
  std::string text = all == 1 ? "it is not closed"
                              : format_count(parts.surface_parts) + " of its " + format_count(all) +
                                    " parts " + (parts.surface_parts == 1 ? "is" : "are") +
                                    " not closed";
  for (const EdgeFault fault : kEdgeFaults) {
    const FaultyEdges& edges = parts.faulty[static_cast<std::size_t>(fault)];
    if (edges.count == 0) continue;
    return text + ": " + counted(edges.count, "edge") + (edges.count == 1 ? " is " : " are ") +
           words_for(fault) + ", the first from " + shown_place(edges.first[0][0]) + " to " +
           shown_place(edges.first[0][1]);
  }
  return text;
}

MeshParts parts_with_solids(const TriangleMesh& mesh, const std::string& name) {
  MeshParts parts = find_parts(mesh);
  if (parts.solids > 0) return parts;
  const std::string faults = faults_of(parts);
  refuse(name, "none of its " + format_count(parts.surface_parts) +
                   " parts is closed, so none has an inside" +
                   (faults.empty() ? std::string() : ": " + faults) +
                   "; expected at least one part whose every edge is of two triangles, once in "
                   "each direction; close the mesh, or search it as a surface");
}

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
