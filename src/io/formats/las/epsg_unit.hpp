#pragma once

#include <cstdint>
#include <optional>

namespace clearway {

/// The unit, in metres, of a projected coordinate reference system with this EPSG code; nullopt
/// where PROJ's database is not installed or lacks the code.
std::optional<double> unit_of_epsg(std::uint16_t code);

}  // namespace clearway
