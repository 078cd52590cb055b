#pragma once

#include <cstdint>
#include <optional>

namespace clearway {

/// Metres of the unit of a projected coordinate reference system by its EPSG code; none where
/// PROJ's database is not installed or does not know it.
std::optional<double> unit_of_epsg(std::uint16_t code);

}  // namespace clearway
