#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "io/journal/journal.hpp"
#include "io/system/xxh64.hpp"

/// Format that the journal's writer and reader share (docs/design/journal.md).
namespace clearway {

inline constexpr char kJournalMagic[8] = {'C', 'L', 'W', 'Y', 'J', 'R', 'N', 'L'};
inline constexpr std::uint64_t kJournalHeadBytes = 16;  // magic, version, 4 zero bytes
inline constexpr std::uint32_t kRecordMark = 0x43525743;
inline constexpr std::uint64_t kMostPayloadBytes = 0xffffffff;

/// The header before every payload.
struct RecordHeader {
  std::uint32_t mark;
  std::uint32_t payload_bytes;
  /// Bytes of the file that were known to be on the disk when this was written.
  std::uint64_t synced_bytes;
  std::uint64_t payload_xxh64;
  std::uint64_t header_xxh64;  ///< hash of the record's position and the 24 bytes before

  std::uint64_t hash_at(std::uint64_t position) const {
    const std::uint64_t parts[4] = {position, mark | std::uint64_t{payload_bytes} << 32,
                                    synced_bytes, payload_xxh64};
    return xxh64(std::as_bytes(std::span(parts)));
  }
  bool valid_at(std::uint64_t position) const {
    return mark == kRecordMark && header_xxh64 == hash_at(position);
  }
};
static_assert(sizeof(RecordHeader) == 32);

inline std::array<std::byte, kJournalHeadBytes> journal_head() {
  std::array<std::byte, kJournalHeadBytes> bytes{};
  std::memcpy(bytes.data(), kJournalMagic, sizeof kJournalMagic);
  std::memcpy(bytes.data() + sizeof kJournalMagic, &kJournalVersion, sizeof kJournalVersion);
  return bytes;
}

}  // namespace clearway
