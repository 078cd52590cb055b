#pragma once

#include <cstdint>
#include <string>

namespace clearway {

/// A coordinate reference system as files name it.
struct ScanCrs {
  std::string wkt;        ///< version 1, where PROJ can say it so, otherwise as it was
  std::string name;       ///< for people
  std::int32_t epsg = 0;  ///< 0: none known
  /// Of its horizontal part, where it has heights of their own; otherwise the same.
  std::int32_t horizontal_epsg = 0;
};

/// Of well-known text, which PROJ need not understand.
ScanCrs scan_crs_of(const std::string& wkt);

/// Of EPSG's code, as GeoTIFF keys give it. Without wkt, and the name is the code alone where
/// PROJ's database is not installed or does not know it.
ScanCrs scan_crs_of_epsg(std::uint16_t code);

}  // namespace clearway
