#pragma once

#include <cstdint>
#include <string>

namespace clearway {

/// A coordinate reference system in the ways that files name it.
struct ScanCrs {
  std::string wkt;   ///< well-known text, version 1 where PROJ can express it, otherwise as found
  std::string name;  ///< name for messages
  std::int32_t epsg = 0;  ///< EPSG code; 0 where none is known
  /// EPSG code of the horizontal part where heights have a system of their own; otherwise the same
  /// as epsg.
  std::int32_t horizontal_epsg = 0;
};

/// The reference system of a well-known text, which PROJ need not understand.
ScanCrs scan_crs_of(const std::string& wkt);

/// The reference system of an EPSG code, as GeoTIFF keys give it. Its wkt is empty and its name is
/// the code alone where PROJ's database is not installed or lacks the code.
ScanCrs scan_crs_of_epsg(std::uint16_t code);

}  // namespace clearway
