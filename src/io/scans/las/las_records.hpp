#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/geometry/quantisation.hpp"
#include "io/files/bytes.hpp"
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

/// Format of the records that a LasRecordWriter takes.
struct LasRecordFormat {
  unsigned point_format = 6;  ///< 0 to 10
  std::uint16_t record_bytes = 30;
  std::uint16_t encoding = 0;  ///< "global encoding" of the file that the records come from
  Quantisation quantisation{};
  /// Descriptions of the extra bytes after the format's own fields.
  std::vector<std::byte> extra_bytes{};
  std::string crs_wkt{};  ///< CRS as well-known text; where empty, geotiff is used
  std::vector<LasRecord> geotiff{};
};

/// Writes a LAS 1.4 file of given point records, front to back. The header with bounds and numbers
/// of returns is written last, so the file must be able to seek; it stands at its start and is
/// owned by the caller. Equal records give equal bytes.
class LasRecordWriter {
 public:
  LasRecordWriter(const File& file, LasRecordFormat format);

  /// Writes a record of format.record_bytes bytes.
  void write(std::span<const std::byte> record);
  void finish();

 private:
  void put_tables(ByteWriter& out) const;
  void put_header(ByteWriter& out) const;
  void put_counts(ByteWriter& out) const;
  bool has_short_counts() const;
  std::uint32_t tables_bytes() const;

  const File& file_;
  LasRecordFormat format_;
  bool wkt_behind_;  ///< whether the CRS's text is too long for a record before the points
  ByteWriter out_;
  std::uint64_t points_ = 0;
  std::array<std::uint64_t, 15> by_return_{};
  QuantumBox bounds_{};
};

}  // namespace clearway
