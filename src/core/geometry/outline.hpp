#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "clearway/outline.hpp"

namespace clearway {

/// On which side of the line from a to b the point c lies: 1 to the left, -1 to the right, 0 on the
/// line. Exact for coordinates that are 0 or of a magnitude from 1e-100 to 1e100. Source: J. R.
/// Shewchuk, Adaptive Precision Floating-Point Arithmetic, 1997.
int side_of(const OutlinePoint& a, const OutlinePoint& b, const OutlinePoint& c);

/// Two edges of a polygon that share more than the corner between neighbours; edge i goes from
/// corner i to the next one. None where the polygon is simple.
std::optional<std::pair<std::size_t, std::size_t>> touching_edges(
    std::span<const OutlinePoint> polygon);

/// Divides a simple polygon with positive area, given in its positive sense of rotation, into
/// triangles of its corners with that sense, none of which is flat: 2 fewer than corners.
std::vector<std::array<std::uint32_t, 3>> triangulated(std::span<const OutlinePoint> polygon);

}  // namespace clearway
