#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "io/formats/wkt.hpp"

namespace clearway {

/// The units that a GeoTIFF key directory (LAS record 34735) names, or those of the projection
/// whose code it gives, where PROJ's database is installed. A directory that is cut off is read as
/// far as it goes. Source: OGC GeoTIFF 1.1, LAS 1.4 R15 section 3.3.
CrsUnits units_of_geotiff(std::span<const std::byte> key_directory);

/// The EPSG code of the coordinate reference system that the keys name; 0 where they name none or a
/// user-defined one.
std::uint16_t epsg_of_geotiff(std::span<const std::byte> key_directory);

}  // namespace clearway
