#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/geometry/quantisation.hpp"
#include "core/geometry/quantum_box.hpp"
#include "io/formats/byte_writer.hpp"
#include "io/formats/las/las_records.hpp"

namespace clearway {

/// Format of the records that a LasRecordWriter takes.
struct LasRecordFormat {
  unsigned point_format = 6;  ///< 0 to 10
  std::uint16_t record_bytes = 30;
  std::uint16_t encoding = 0;  ///< "global encoding" of the file that the records come from
  Quantisation quantisation{};
  /// Descriptions of the extra bytes behind the format's own fields.
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
