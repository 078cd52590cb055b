#pragma once

#include <cstddef>
#include <span>

#include "io/formats/point_reader.hpp"

namespace clearway {

/// The unit of the horizontal coordinates that a GeoTIFF key directory (LAS record 34735) names;
/// kUnknown where it gives a code of a projection only. A directory that is cut is read as far as
/// it goes. Source: OGC GeoTIFF 1.1, LAS 1.4 R15 section 3.3.
LengthUnit horizontal_unit(std::span<const std::byte> key_directory);

}  // namespace clearway
