#include "io/models/mesh_facts.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <tuple>
#include <utility>

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

/// Calls visit(uses of one edge) for every edge, which flat triangles do not have. The uses of an
/// edge are in the order of their triangles.
template <typename Visit>
void for_each_edge(const std::vector<Corners>& triangles, Visit visit) {
  std::vector<EdgeUse> uses;
  uses.reserve(3 * triangles.size());
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    const auto& [a, b, c] = triangles[i];
    if (is_flat(triangles[i])) continue;
    for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
      uses.push_back({std::min(from, to), std::max(from, to), i, from < to});
    }
  }
  std::ranges::sort(uses, {},
                    [](const EdgeUse& use) { return std::tuple(use.low, use.high, use.triangle); });
  for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
    while (end < uses.size() && uses[end].low == uses[begin].low &&
           uses[end].high == uses[begin].high) {
      ++end;
    }
    visit(std::span<const EdgeUse>(uses).subspan(begin, end - begin));
  }
}

/// What keeps the part of an edge from being a solid; nullopt where the edge is sound.
std::optional<EdgeFault> fault_of(std::span<const EdgeUse> edge) {
  if (edge.size() == 1) return EdgeFault::kOpen;
  if (edge.size() > 2) return EdgeFault::kCrowded;
  if (edge[0].upwards == edge[1].upwards) return EdgeFault::kSameWay;
  return std::nullopt;
}

/// Least number of triangles of a solid; with fewer, a closed part encloses nothing.
constexpr std::uint32_t kLeastOfSolid = 4;

/// Numbers the solids. sets: the triangles of each part. faulty: triangles with a faulty edge,
/// among them one at least of each part that has one.
void number_solids(DisjointSets& sets, const std::vector<bool>& faulty, MeshParts& parts) {
  const std::vector<Corners>& triangles = parts.mesh.triangles;
  const auto count = static_cast<std::uint32_t>(triangles.size());
  std::vector<std::uint32_t> size_of(count), number_of(count, kNoSolid);
  std::vector<bool> open(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    if (is_flat(triangles[i])) continue;
    ++size_of[sets.root(i)];
    if (faulty[i]) open[sets.root(i)] = true;
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    if (size_of[i] >= kLeastOfSolid && !open[i]) {
      number_of[i] = parts.solids++;
    } else {
      parts.surface_parts += size_of[i] > 0 ? 1 : 0;
    }
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    const bool flat = is_flat(triangles[i]);
    parts.solid_of.push_back(flat ? kNoSolid : number_of[sets.root(i)]);
    parts.flat += flat ? 1 : 0;
    parts.surface_triangles += parts.solid_of[i] == kNoSolid ? 1 : 0;
  }
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

/// The edges with one fault in words, with the places of the first few.
std::string fault_text(EdgeFault fault, const FaultyEdges& edges) {
  std::string text = counted(edges.count, "edge") + (edges.count == 1 ? " is " : " are each ") +
                     words_for(fault) + (edges.count == 1 ? ", from " : ", the first from ");
  for (std::size_t i = 0; i < edges.first.size(); ++i) {
    text += (i > 0 ? ", from " : "") + shown_place(edges.first[i][0]) + " to " +
            shown_place(edges.first[i][1]);
  }
  return text;
}

}  // namespace

MeshParts find_parts(const TriangleMesh& mesh) {
  MeshParts parts;
  parts.mesh = merged(mesh);
  const std::vector<Vec3>& vertices = parts.mesh.vertices;
  parts.duplicates = leave_out_duplicates(parts.mesh.triangles);
  DisjointSets sets(parts.mesh.triangles.size());
  std::vector<bool> faulty(parts.mesh.triangles.size());
  for_each_edge(parts.mesh.triangles, [&](std::span<const EdgeUse> edge) {
    for (const EdgeUse& use : edge) sets.join(edge[0].triangle, use.triangle);
    const auto fault = fault_of(edge);
    if (!fault) return;
    faulty[edge[0].triangle] = true;
    FaultyEdges& edges = parts.faulty[static_cast<std::size_t>(*fault)];
    if (edges.count++ >= FaultyEdges::kMostShown) return;
    edges.first.push_back({vertices[edge[0].low], vertices[edge[0].high]});
  });
  number_solids(sets, faulty, parts);
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
    if (edges.count > 0) text += (text.empty() ? "" : "; ") + fault_text(fault, edges);
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
    FaultyEdges edges = parts.faulty[static_cast<std::size_t>(fault)];
    if (edges.count == 0) continue;
    edges.first.resize(1);
    return text + ": " + fault_text(fault, edges);
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

MeshFacts facts_of(const TriangleMesh& mesh) {
  MeshFacts facts;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3& corner = mesh.vertices[a];
    const Vec3 normal = cross(mesh.vertices[b] - corner, mesh.vertices[c] - corner);
    const double area = std::hypot(normal.x, normal.y, normal.z) / 2;
    facts.area += area;
    if (!(area > 0)) ++facts.flat_triangles;
  }
  const std::vector<Corners> triangles = merged(mesh).triangles;
  std::uint64_t* const faulty[] = {&facts.open_edges, &facts.crowded_edges, &facts.flipped_edges};
  for_each_edge(triangles, [&](std::span<const EdgeUse> edge) {
    ++facts.edges;
    if (const auto fault = fault_of(edge)) ++*faulty[static_cast<std::size_t>(*fault)];
  });
  DisjointSets sets(mesh.vertices.size());
  std::vector<bool> used(mesh.vertices.size());
  for (const Corners& triangle : triangles) {
    for (const std::uint32_t corner : triangle) {
      sets.join(triangle[0], corner);
      used[corner] = true;
    }
  }
  for (std::uint32_t i = 0; i < used.size(); ++i) facts.parts += used[i] && sets.root(i) == i;
  return facts;
}

}  // namespace clearway
