#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "io/formats/input_buffer.hpp"
#include "io/formats/las/las_header.hpp"
#include "io/formats/point_reader.hpp"
#include "io/formats/wkt.hpp"

namespace clearway {

/// What the variable length records say of the coordinate reference system.
struct LasCrs {
  std::string wkt;          ///< of user LASF_Projection
  std::string foreign_wkt;  ///< the same record as liblas repeats it
  CrsUnits geotiff;
  std::uint16_t geotiff_epsg = 0;  ///< code that the GeoTIFF keys name; 0: none

  /// Sets info's CRS and unit; well-known text counts more than GeoTIFF keys.
  void describe(CloudInfo& info) const;
};

/// A variable length record.
struct LasRecord {
  std::string user;
  std::uint16_t id = 0;
  std::vector<std::byte> payload;
  friend bool operator==(const LasRecord&, const LasRecord&) = default;
};

/// What is kept of the records before the points.
struct LasRecords {
  LasCrs crs;
  std::vector<std::byte> laz;  ///< how the points are compressed; empty where nothing says so
  std::vector<std::byte> extra_bytes;  ///< descriptions of the points' extra bytes
  std::vector<LasRecord> geotiff;      ///< the CRS in GeoTIFF's three records, where they are there
};

/// Reads the variable length records and leaves the input at the first point record.
void read_las_vlrs(InputBuffer& input, const LasPublicHeader& header, LasRecords& records);

/// Reads the extended variable length records from the input's position, which must not be behind
/// the first of them. Throws InputError where they do not end within the file.
void read_las_tail(InputBuffer& input, const LasPublicHeader& header, LasCrs& crs);

}  // namespace clearway
