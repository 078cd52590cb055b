#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace clearway::laz {

/// How the points of a LAZ file are compressed, according to its record 22204 of user "laszip
/// encoded".
struct Scheme {
  enum class Chunks { kNone, kPointwise, kLayered };

  Chunks chunks = Chunks::kNone;
  /// Number of points of every chunk except the last; nullopt where the chunk table has the
  /// numbers.
  std::optional<std::uint32_t> chunk_points;
  // The versions of a record's items, in the order of the record; 0 where it lacks the item.
  unsigned point_version = 0;  ///< POINT10, or POINT14 where layered
  unsigned gps_time_version = 0;
  unsigned rgb_version = 0;
  unsigned wave_packet_version = 0;
  unsigned bytes_version = 0;
  std::uint16_t bytes = 0;         ///< number of extra bytes in a record
  std::uint16_t record_bytes = 0;  ///< bytes of all items
  std::uint32_t layers = 0;        ///< number of layers of all items, where layered
  /// Whether the GPS times are wanted too; only where the points have some.
  bool with_times = false;
  bool with_flags = false;  ///< whether the flags are wanted too

  /// Whether the points have GPS times.
  bool has_times() const { return chunks == Chunks::kLayered || gps_time_version > 0; }
};

/// Reads the scheme from the record's payload. name: the file's, for messages. Throws InputError
/// for contents that no LAZ file has or that are not read, and where the items do not match the
/// header's point format and record size.
Scheme read_scheme(const std::string& name, std::span<const std::byte> payload,
                   unsigned point_format, std::uint16_t record_bytes);

}  // namespace clearway::laz
