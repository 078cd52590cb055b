#pragma once

#include <cstdint>
#include <string>

#include "core/geometry/quantisation.hpp"
#include "io/formats/input_buffer.hpp"
#include "io/formats/point_reader.hpp"

namespace clearway {

/// The part of a LAS file's public header block that reading coordinates needs.
/// Source: ASPRS LAS 1.4 R15, section 2.4, and its predecessors 1.0 to 1.3.
struct LasPublicHeader {
  std::uint16_t header_bytes;
  std::uint32_t points_offset;  ///< byte of the first point record
  std::uint32_t vlr_count;
  std::uint16_t record_bytes;  ///< of a point record; coordinates are its first 12 bytes
  std::uint64_t points;
  Quantisation quantisation;
  std::uint64_t tail_offset;  ///< byte of the first extended variable length record
  std::uint32_t tail_count;   ///< number of those records; 0: none

  std::uint64_t points_end() const;  ///< byte behind the last point record
};

/// What the variable length records say of the coordinate reference system.
struct LasCrs {
  std::string wkt;          ///< of user LASF_Projection
  std::string foreign_wkt;  ///< the same record as liblas repeats it
  LengthUnit geotiff_unit = LengthUnit::kUnknown;

  /// Sets info's CRS and unit; well-known text counts more than GeoTIFF keys.
  void describe(CloudInfo& info) const;
};

/// Reads the public header block and leaves the input behind it. Throws InputError for anything
/// malformed, for LAZ, and where the file's size is known and too small for what is declared.
LasPublicHeader read_las_header(InputBuffer& input);

/// Reads the variable length records and leaves the input at the first point record.
void read_las_vlrs(InputBuffer& input, const LasPublicHeader& header, LasCrs& crs);

/// Reads the extended variable length records from the input's position, which must not be behind
/// the first of them. Throws InputError where they do not end within the file.
void read_las_tail(InputBuffer& input, const LasPublicHeader& header, LasCrs& crs);

}  // namespace clearway
