#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "clearway/vec3.hpp"

namespace clearway {

/// A polygon cut into triangles.
struct CutPolygon {
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices of corners within the polygon
  double bend = 0;  ///< distance of the farthest corner from the plane through the corners' mean
  bool crossing = false;  ///< whether the outline crosses itself, so that the cut is arbitrary
};

/// Most corners of a polygon that is not a fan; more would take too long.
inline constexpr std::size_t kMostCornersToCut = 1024;
/// Most corners of any face.
inline constexpr std::size_t kMostCorners = 1'000'000;

/// Whether all triangles of the fan about the first corner turn the same way.
bool is_fan(std::span<const Vec3> corners);

/// Cuts a polygon with three corners or more into triangles: a fan where is_fan(), otherwise ears,
/// in the projection along the axis in which its normal is largest. Polygons cut into ears may have
/// at most kMostCornersToCut corners. Source: G. Meisters, Polygons have ears, 1975.
CutPolygon cut_polygon(std::span<const Vec3> corners);

}  // namespace clearway
