#pragma once

#include <string_view>

#include "io/formats/point_reader.hpp"

namespace clearway {

/// The unit of the horizontal coordinates of a coordinate reference system in well-known text 1 or
/// 2; kUnknown where the text does not say or cannot be parsed.
/// Source: OGC 01-009 and OGC 18-010.
LengthUnit horizontal_unit(std::string_view wkt);

}  // namespace clearway
