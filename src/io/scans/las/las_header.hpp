#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "clearway/box.hpp"
#include "core/geometry/quantisation.hpp"
#include "io/scans/input_buffer.hpp"
#include "io/scans/point_reader.hpp"

namespace clearway {

/// The position of the class in the records of a point format.
struct LasClassField {
  std::size_t byte;
  std::uint8_t mask;

  std::uint8_t of(const std::byte* record) const {
    return static_cast<std::uint8_t>(std::to_integer<std::uint8_t>(record[byte]) & mask);
  }
};

/// The position of the class in a point format. In formats 0 to 5 its byte also holds three flags.
constexpr LasClassField las_class_field(unsigned point_format) {
  return point_format < 6 ? LasClassField{15, 0x1F} : LasClassField{16, 0xFF};
}

/// The flags in the class byte of point formats 0 to 5, as bits of PointFlags. Points in an overlap
/// have class 12 there.
constexpr std::uint8_t las_flags_of_class_byte(std::uint8_t byte) {
  constexpr std::uint8_t kMask = 0x1F, kOverlapClass = 12;
  return static_cast<std::uint8_t>(byte >> 5 |
                                   ((byte & kMask) == kOverlapClass ? PointFlags::kOverlap : 0));
}

/// The flags of a record in a point format, as bits of PointFlags.
inline std::uint8_t las_flags_of(const std::byte* record, unsigned point_format) {
  const auto byte = std::to_integer<std::uint8_t>(record[15]);
  return point_format < 6 ? las_flags_of_class_byte(byte) : static_cast<std::uint8_t>(byte & 0x0F);
}

/// The byte at which the GPS time, a double, begins in the records of a point format; nullopt where
/// it has none.
constexpr std::optional<std::size_t> las_time_byte(unsigned point_format) {
  if (point_format >= 6) return 22;
  if (point_format == 0 || point_format == 2) return std::nullopt;
  return 20;
}

/// The part of a LAS file's public header block that reading coordinates needs.
/// Source: ASPRS LAS 1.4 R15, section 2.4, and its predecessors 1.0 to 1.3.
struct LasPublicHeader {
  std::uint16_t header_bytes;
  std::uint32_t points_offset;  ///< byte of the first point record
  std::uint32_t vlr_count;
  std::uint16_t record_bytes;  ///< bytes of a point record, whose first 12 are the coordinates
  std::uint64_t points;
  unsigned point_format;   ///< 0 to 10
  bool compressed;         ///< whether the file is LAZ
  bool has_flags;          ///< whether points have flags; in LAS 1.0 their bits belong to the class
  std::uint16_t encoding;  ///< the bits of "global encoding"
  std::string date;        ///< day on which the file was made, as in CloudInfo
  Quantisation quantisation;
  std::optional<Box> box;     ///< declared box of all points, where it holds finite numbers
  std::uint64_t tail_offset;  ///< byte of the first extended variable length record
  std::uint32_t tail_count;   ///< number of extended variable length records

  std::uint64_t points_end() const;  ///< byte after the last point record, if not compressed
};

/// Throws InputError for a file that ends before what it declares; the input has met its end.
[[noreturn]] void refuse_cut_las(const InputBuffer& input, const std::string& expected);

/// Reads the public header block and leaves the input after it. Throws InputError for anything
/// malformed, and where the file's size is known and too small for what is declared.
LasPublicHeader read_las_header(InputBuffer& input);

}  // namespace clearway
