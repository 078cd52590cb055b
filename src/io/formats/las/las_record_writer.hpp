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

/// Of the records that a LasRecordWriter takes.
struct LasRecordFormat {
  unsigned point_format = 6;  ///< 0 to 10
  std::uint16_t record_bytes = 30;
  std::uint16_t encoding = 0;  ///< "global encoding" of the file they come from
  Quantisation quantisation{};
  std::vector<std::byte> extra_bytes{};  ///< descriptions of what is behind the format's own fields
  std::string crs_wkt{};                 ///< where it is empty, geotiff counts
  std::vector<LasRecord> geotiff{};
};

/// Writes a LAS 1.4 file of point records as they are given, front to back; the header, with bounds
/// and counts of returns, at last. Equal records give equal bytes. The file can seek, stands at its
/// start and stays the caller's.
class LasRecordWriter {
 public:
  LasRecordWriter(const File& file, LasRecordFormat format);

  /// A record of format.record_bytes bytes.
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
  bool wkt_behind_;  ///< too long for a record before the points
  ByteWriter out_;
  std::uint64_t points_ = 0;
  std::array<std::uint64_t, 15> by_return_{};
  QuantumBox bounds_{};
};

}  // namespace clearway
