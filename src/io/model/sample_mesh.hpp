#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "clearway/vec3.hpp"
#include "io/formats/mesh/triangle_mesh.hpp"

namespace clearway {

inline constexpr std::uint64_t kMostSamples = 50'000'000;
inline constexpr double kLeastSpacing = 1e-9, kLargestSpacing = 1e9;  // metres

/// Points on a mesh's surface such that no place of it is farther than `spacing` from the nearest:
/// the vertices of its triangles, followed by the other points that are needed. Each lies on its
/// triangle up to an error of 2^-48 of the largest coordinate. The same mesh gives the same points
/// in the same order. Throws InputError, which begins with `name`, where more than kMostSamples are
/// needed, and for a spacing too fine for the size of the coordinates. docs/design/model.md has the
/// proof.
std::vector<Vec3> sample_mesh(const TriangleMesh& mesh, double spacing, const std::string& name);

/// Greatest distance of a place of the triangles from the nearest vertex of its own triangle,
/// metres. above: counts only places and vertices that are not below this height.
double distance_to_vertices(const TriangleMesh& mesh, std::optional<double> above);

/// A spacing that gives about so many samples besides the vertices, and is never refused.
double spacing_for(const TriangleMesh& mesh, double samples);

/// About so many points on a mesh's surface besides its vertices, for drawing.
inline std::vector<Vec3> drawn_points(const TriangleMesh& mesh, double samples) {
  return sample_mesh(mesh, spacing_for(mesh, samples), "the model");
}

}  // namespace clearway
