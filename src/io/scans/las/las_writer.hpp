#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry/quantisation.hpp"
#include "io/files/bytes.hpp"
#include "io/files/file.hpp"
#include "io/scans/las/las_records.hpp"
#include "io/scans/point_field.hpp"

namespace clearway {

// Extra bytes of LAS records: values that every record has after those of its point format.
// Source: LAS 1.4 R15 (ASPRS), "Extra Bytes VLR".

constexpr std::uint16_t kLasExtraBytes = 192;  ///< size of a field's description

/// Describes a field of extra bytes. type: its code in the specification, 0 for an undocumented
/// field. options: the number of bytes of an undocumented field, otherwise flags.
std::array<std::byte, kLasExtraBytes> las_extra_bytes(std::string_view name, std::uint8_t type,
                                                      std::uint8_t options,
                                                      std::string_view description);

/// How the records of a LAS file are made up, and what its header says besides their number.
struct LasFormat {
  unsigned minor = 4;         ///< of the version 1.minor: 2 or 4
  unsigned point_format = 6;  ///< 0 to 10
  std::uint16_t record_bytes = 30;
  std::uint16_t encoding = 0;    ///< "global encoding" of the file that the records come from
  const char* system = "OTHER";  ///< "system identifier": what made the points
  Quantisation quantisation{};
  /// Descriptions of the extra bytes after the format's own fields.
  std::vector<std::byte> extra_bytes{};
  std::vector<PointField> fields{};  ///< those that add() added
  std::string crs_wkt{};             ///< CRS as well-known text; where empty, geotiff is used
  std::vector<LasRecord> geotiff{};

  /// The format of points that have only coordinates and fields: version 1.2 with point format 0,
  /// or 1.4 with point format 6 where the count exceeds 32 bits or where there is a CRS or a field,
  /// for which 1.4 has a place.
  static LasFormat of_points(const Quantisation& quantisation, std::uint64_t points,
                             std::string crs_wkt = {}, const std::vector<PointField>& fields = {});
  /// Adds a field to the end of the records. A class gets no bytes, as point formats have a place
  /// for it. Throws InputError where a record has no room for the field.
  void add(const PointField& field);
};

/// What the header of a LAS file says of all points.
struct LasTotals {
  std::uint64_t points = 0;
  QuantumBox bounds{};                        ///< box of all points; ignored for 0 points
  std::array<std::uint64_t, 15> by_return{};  ///< numbers of first returns, second ones and so on
};

/// Writes a LAS file. Where the totals are declared before the first point, it is written front to
/// back, so that the output may be a pipe. Otherwise the header is written again at the end, for
/// which the file must be able to seek; it stands at its start. Equal contents give equal bytes, as
/// no date is written. Output is buffered; the caller owns the file.
class LasWriter {
 public:
  LasWriter(const File& file, LasFormat format, std::optional<LasTotals> declared = {});

  /// Writes a record of format.record_bytes bytes.
  void write(std::span<const std::byte> record);
  /// Writes points of a format made by of_points(). values: those of each of its fields. Throws
  /// std::logic_error where they do not fit.
  void write(std::span<const std::array<std::int32_t, 3>> quanta,
             std::span<const FieldValues> values = {});

  /// Flushes. Throws std::logic_error where another number of points was declared.
  void finish();

 private:
  struct Table {
    LasRecord record;
    const char* description;
  };

  void put_header(const LasTotals& totals);
  template <typename Bytes>
  void put_table(const Table& table);

  const File& file_;
  LasFormat format_;
  std::optional<LasTotals> declared_;
  std::vector<Table> tables_;
  std::optional<Table> behind_;  ///< the CRS, where its text is too long for a table before points
  LasTotals written_;
  ByteWriter out_;
};

}  // namespace clearway
