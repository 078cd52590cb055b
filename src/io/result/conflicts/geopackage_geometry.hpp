#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "clearway/vec3.hpp"

namespace clearway {

/// Shape of a geometry, with its number in well-known binary.
enum class GeoShape : std::uint32_t { kPoint = 1, kLine = 2, kPolygon = 3 };

/// A geometry with heights in the form of a GeoPackage: its header with the box in x and y, then
/// little-endian well-known binary. points: a single point, those of a line, or a closed ring.
/// Source: OGC 12-128r17, 2.1.3; OGC 06-103r4.
std::vector<std::byte> geometry_bytes(GeoShape shape, std::span<const Vec3> points,
                                      std::int32_t srs);

}  // namespace clearway
