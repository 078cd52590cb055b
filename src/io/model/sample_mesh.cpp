#include "io/model/sample_mesh.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/point_box.hpp"
#include "core/util/format.hpp"
#include "io/formats/mesh/vertex_welder.hpp"
#include "io/model/surface_cover.hpp"
#include "io/model/triangle_frame.hpp"
#include "io/system/input_error.hpp"

namespace clearway {
namespace {

// Greatest coordinate in spacings, which the proof requires.
constexpr double kMostSpacings = 0x1p28;

/// The positions of the vertices that triangles use, each once, in the order of the vertices.
std::vector<Vec3> used_vertices(const TriangleMesh& mesh) {
  std::vector<bool> used(mesh.vertices.size());
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) used[corner] = true;
  }
  std::vector<Vec3> places;
  VertexWelder welder(places);
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (used[i]) welder.number_of(mesh.vertices[i]);
  }
  return places;
}

double estimate(const TriangleMesh& mesh, double spacing) {
  const SurfaceCover cover(spacing, 0);
  double samples = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    samples += cover.estimate(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]);
  }
  return samples;
}

/// The next greater round number of the series 1, 2, 5, 10 ...
double rounder(double spacing) {
  const double power = std::pow(10, std::floor(std::log10(spacing)));
  for (const double digit : {1, 2, 5}) {
    if (digit * power > spacing * 1.0001) return digit * power;
  }
  return 10 * power;
}

[[noreturn]] void refuse_spacing(const TriangleMesh& mesh, double spacing, double samples,
                                 const std::vector<Vec3>& vertices, const std::string& name) {
  double fits = spacing;
  do {
    fits = rounder(fits);
  } while (fits < kLargestSpacing && estimate(mesh, fits) > kMostSamples / 2.0);
  const Box box = box_of(vertices);
  refuse(name,
         "the mesh is " + format_brief(box.hi.x - box.lo.x) + " x " +
             format_brief(box.hi.y - box.lo.y) + " x " + format_brief(box.hi.z - box.lo.z) +
             " m; at a spacing of " + format_number(spacing) + " m it takes " +
             (samples > 0 ? "some " + format_brief(samples) + " points" : "more points") +
             ", and at most " + format_count(kMostSamples) +
             " are allowed. Is the file in metres? A spacing of " + format_number(fits) +
             " m is possible",
         Remedy::kModelSpacing, fits);
}

void check_spacing(const std::vector<Vec3>& vertices, double spacing, const std::string& name) {
  if (!(spacing >= kLeastSpacing && spacing <= kLargestSpacing)) {
    throw UsageError(name + ": a model spacing of " + shown(spacing) +
                     " m; expected one from 1e-9 to 1e9");
  }
  double largest = 0;
  for (const Vec3& v : vertices) {
    largest = std::max({largest, std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  }
  if (largest > spacing * kMostSpacings) {
    refuse(name,
           "coordinates up to " + format_brief(largest) + " m are too large for a spacing of " +
               format_number(spacing) + " m; expected at most " +
               format_brief(spacing * kMostSpacings) + " m. Move the model to its own origin",
           Remedy::kModelSpacing, 0);
  }
}

}  // namespace

std::vector<Vec3> sample_mesh(const TriangleMesh& mesh, double spacing, const std::string& name) {
  const std::vector<Vec3> vertices = used_vertices(mesh);
  check_spacing(vertices, spacing, name);
  const double expected = estimate(mesh, spacing);
  if (expected > kMostSamples) refuse_spacing(mesh, spacing, expected, vertices, name);
  SurfaceCover cover(spacing, kMostSamples);
  for (const Vec3& vertex : vertices) cover.add(vertex);
  for (const auto& [a, b, c] : mesh.triangles) {
    if (!cover.cover(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c])) {
      refuse_spacing(mesh, spacing, expected, vertices, name);
    }
  }
  return cover.samples().take_points();
}

double distance_to_vertices(const TriangleMesh& mesh, std::optional<double> above) {
  double farthest = 0;
  for (const auto& triangle : mesh.triangles) {
    const auto below = std::ranges::count_if(
        triangle, [&](std::uint32_t i) { return above && mesh.vertices[i].z < *above; });
    if (below == 3) continue;
    const auto& [a, b, c] = triangle;
    const TriangleFrame frame(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]);
    const bool is_whole = below == 0;  // otherwise the nearest vertex may be left out
    farthest = std::max(farthest, !is_whole          ? frame.length
                                  : frame.height > 0 ? frame.corner_distance()
                                                     : frame.length / 2);
  }
  return farthest;
}

double spacing_for(const TriangleMesh& mesh, double samples) {
  double area = 0, reach = 0;
  for (const auto& [i, j, k] : mesh.triangles) {
    const Vec3 &a = mesh.vertices[i], &b = mesh.vertices[j], &c = mesh.vertices[k];
    const Vec3 ab = difference(b, a), ac = difference(c, a);
    const Vec3 normal{ab.y * ac.z - ab.z * ac.y, ab.z * ac.x - ab.x * ac.z,
                      ab.x * ac.y - ab.y * ac.x};
    area += std::sqrt(squared_length(normal.x, normal.y, normal.z)) / 2;
    for (int axis = 0; axis < 3; ++axis) {
      reach = std::max({reach, std::abs(a[axis]), std::abs(b[axis]), std::abs(c[axis])});
    }
  }
  // A lattice of equilateral triangles whose places are within h of a node has 2 / (3 sqrt(3) h^2)
  // nodes per area (Kershner 1939).
  const double of_area = std::sqrt(2 * area / (3 * std::sqrt(3.0) * samples));
  double spacing =
      std::clamp(std::max(of_area, reach * 0x1p-27), 2 * kLeastSpacing, kLargestSpacing / 2);
  // Lines have no area. Triangles about as large as the spacing need up to fifteen times as many
  // samples as their area suggests, which does no harm.
  constexpr double kMuchMore = 32;
  while (spacing < kLargestSpacing / 2 && estimate(mesh, spacing) > kMuchMore * samples) {
    spacing = std::min(2 * spacing, kLargestSpacing / 2);
  }
  return spacing;
}

}  // namespace clearway
