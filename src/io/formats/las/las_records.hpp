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

/// The coordinate reference system in the variable length records.
struct LasCrs {
  std::string wkt;          ///< from the record of user LASF_Projection
  std::string foreign_wkt;  ///< from the copy of that record that liblas writes
  CrsUnits geotiff;
  std::uint16_t geotiff_epsg = 0;  ///< EPSG code in the GeoTIFF keys; 0 for none

  /// Sets the CRS and unit of `info`; well-known text takes precedence over GeoTIFF keys.
  void describe(CloudInfo& info) const;
};

/// A variable length record: user id, record id and contents.
struct LasRecord {
  std::string user;
  std::uint16_t id = 0;
  std::vector<std::byte> payload;
  friend bool operator==(const LasRecord&, const LasRecord&) = default;
};

/// Contents of the records before the points.
struct LasRecords {
  LasCrs crs;
  std::vector<std::byte> laz;  ///< record of the points' compression; empty where there is none
  std::vector<std::byte> extra_bytes;  ///< descriptions of the points' extra bytes
  std::vector<LasRecord> geotiff;      ///< up to three GeoTIFF records of the CRS
};

/// Reads the variable length records and leaves the input at the first point record.
void read_las_vlrs(InputBuffer& input, const LasPublicHeader& header, LasRecords& records);

/// Reads the extended variable length records. The input must not be behind the first of them.
/// Throws InputError where they do not end within the file.
void read_las_tail(InputBuffer& input, const LasPublicHeader& header, LasCrs& crs);

}  // namespace clearway
