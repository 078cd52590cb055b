#pragma once

#include <array>
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
  /// The items of a record in their order: POINT10, or POINT14 where layered, GPS time, colours,
  /// wave packet and extra bytes.
  enum Item : std::uint8_t { kPoint, kGpsTime, kRgb, kWavePacket, kBytes, kItems };
  std::array<unsigned, kItems> versions{};  ///< of the items; 0 where a record lacks the item
  std::uint16_t bytes = 0;                  ///< number of extra bytes in a record
  std::uint16_t record_bytes = 0;           ///< bytes of all items
  std::uint32_t layers = 0;                 ///< number of layers of all items, where layered
  /// Whether the GPS times are wanted too; only where the points have some.
  bool with_times = false;
  bool with_flags = false;  ///< whether the flags are wanted too

  /// Whether the points have GPS times.
  bool has_times() const { return chunks == Chunks::kLayered || versions[kGpsTime] > 0; }
};

/// Reads the scheme from the record's payload. name: the file's, for messages. Throws InputError
/// for contents that no LAZ file has or that are not read, and where the items do not match the
/// header's point format and record size.
Scheme read_scheme(const std::string& name, std::span<const std::byte> payload,
                   unsigned point_format, std::uint16_t record_bytes);

}  // namespace clearway::laz
