#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "io/scans/input_buffer.hpp"
#include "io/scans/las/geotiff_keys.hpp"
#include "io/scans/las/las_header.hpp"
#include "io/scans/point_reader.hpp"
#include "io/scans/stated_crs.hpp"

namespace clearway {

/// What the variable length records say of the coordinate reference system and of the place of the
/// points in it.
struct LasCrs {
  std::string wkt;          ///< from the record of user LASF_Projection
  std::string foreign_wkt;  ///< from the copy of that record that liblas writes
  GeotiffKeys geotiff;
  std::string unplaced;  ///< see StatedCrs

  /// What all of it says. Well-known text takes precedence over GeoTIFF keys; where PROJ does not
  /// read the one, the other counts.
  StatedCrs stated() const;
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
  std::vector<std::byte> laz;   ///< record of the points' compression; empty where there is none
  std::vector<std::byte> copc;  ///< record about the octree of COPC; empty where there is none
  std::vector<std::byte> extra_bytes;  ///< descriptions of the points' extra bytes
  std::vector<LasRecord> geotiff;      ///< up to three GeoTIFF records of the CRS
};

/// Reads the variable length records and leaves the input at the first point record.
void read_las_vlrs(InputBuffer& input, const LasPublicHeader& header, LasRecords& records);

/// Reads the extended variable length records. The input must not be after the first of them.
/// Throws InputError where they do not end within the file.
void read_las_tail(InputBuffer& input, const LasPublicHeader& header, LasCrs& crs);

}  // namespace clearway
