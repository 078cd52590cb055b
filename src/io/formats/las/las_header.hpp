#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "clearway/box.hpp"
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
  std::uint16_t record_bytes;  ///< bytes of a point record, whose first 12 are the coordinates
  std::uint64_t points;
  unsigned point_format;   ///< 0 to 10
  bool compressed;         ///< whether the file is LAZ
  std::uint16_t encoding;  ///< the bits of "global encoding"
  Quantisation quantisation;
  std::optional<Box> box;     ///< declared box of all points, where it holds finite numbers
  std::uint64_t tail_offset;  ///< byte of the first extended variable length record
  std::uint32_t tail_count;   ///< number of extended variable length records

  std::uint64_t points_end() const;  ///< byte behind the last point record, if not compressed
};

/// Throws InputError for a file that ends before what it declares; the input has met its end.
[[noreturn]] void refuse_cut_las(const InputBuffer& input, const std::string& expected);

/// Reads the public header block and leaves the input behind it. Throws InputError for anything
/// malformed, and where the file's size is known and too small for what is declared.
LasPublicHeader read_las_header(InputBuffer& input);

}  // namespace clearway
