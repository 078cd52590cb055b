#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "clearway/vec3.hpp"

namespace clearway {

/// A polygon cut into triangles.
struct CutPolygon {
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< of positions within the polygon
  double bend = 0;        ///< the farthest corner from the plane through the corners' mean
  bool crossing = false;  ///< the outline crosses itself: how it is cut is arbitrary
};

/// Corners of a polygon that is not convex; more would take too long.
inline constexpr std::size_t kMostCornersToCut = 1024;
/// Of any face.
inline constexpr std::size_t kMostCorners = 1'000'000;

/// Whether all of a fan's triangles about the first corner turn the same way.
bool is_fan(std::span<const Vec3> corners);

/// Cuts a polygon with three corners or more: a fan where is_fan(), otherwise ears, in the
/// projection along the axis in which its normal is largest. Ears need at most kMostCornersToCut.
/// Source: G. Meisters, Polygons have ears, 1975.
CutPolygon cut_polygon(std::span<const Vec3> corners);

}  // namespace clearway
