#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace clearway::laz {

/// How the points of a LAZ file are compressed, as its record 22204 of user "laszip encoded" says.
struct Scheme {
  enum class Chunks { kNone, kPointwise, kLayered };

  Chunks chunks = Chunks::kNone;
  /// Points of every chunk but the last; none where the chunk table has their numbers.
  std::optional<std::uint32_t> chunk_points;
  // The items of a record in their order, by their version; 0: none of it.
  unsigned point_version = 0;  ///< POINT10, or POINT14 where layered
  unsigned gps_time_version = 0;
  unsigned rgb_version = 0;
  unsigned wave_packet_version = 0;
  unsigned bytes_version = 0;
  std::uint16_t bytes = 0;         ///< extra bytes of a record
  std::uint16_t record_bytes = 0;  ///< all items
  std::uint32_t layers = 0;        ///< of all items, where layered
};

/// From the record's payload. Throws InputError of file `name` for what no LAZ file has or what is
/// not read, and where the items are not those of the header's point format and record size.
Scheme read_scheme(const std::string& name, std::span<const std::byte> payload,
                   unsigned point_format, std::uint16_t record_bytes);

}  // namespace clearway::laz
