#pragma once

#include <cstdint>
#include <string>

namespace clearway {

/// A coordinate reference system as files name it.
struct ScanCrs {
  std::string wkt;        ///< version 1, where PROJ can say it so, otherwise as it was
  std::string name;       ///< for people
  std::int32_t epsg = 0;  ///< 0: none known
};

/// Of well-known text, which PROJ need not understand.
ScanCrs scan_crs_of(const std::string& wkt);

}  // namespace clearway
