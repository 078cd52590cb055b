#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "io/files/file.hpp"
#include "io/files/xxh64.hpp"

/// The journal of an unfinished run: an append-only file of checksummed records
/// (docs/design/journal.md).
namespace clearway {

inline constexpr std::uint32_t kJournalVersion = 3;

/// The identity of a journal, which says what it belongs to, as named values in a fixed order.
using JournalIdentity = std::vector<std::pair<std::string, std::string>>;

/// The first name of the identity of a conversion's journal. A run's journal has none of that name.
inline constexpr const char* kJournalOfConversion = "conversion";

inline bool is_of_conversion(const JournalIdentity& identity) {
  return !identity.empty() && identity.front().first == kJournalOfConversion;
}

/// The path of an output's journal: the output's name with ".journal" appended.
std::filesystem::path journal_of(const std::filesystem::path& output);

/// Whether the path is a file that begins as a journal does.
bool is_journal(const std::filesystem::path& path);

/// The difference between two identities in words, as in "radius is 0.2, expected 0.1"; empty where
/// there is none.
std::string difference(const JournalIdentity& found, const JournalIdentity& expected);

/// A record under construction: room for its header, then the payload.
class JournalRecord {
 public:
  JournalRecord() { clear(); }

  template <typename Value>
  requires std::is_trivially_copyable_v<Value>
  void put(const Value& value) {
    const auto bytes = std::as_bytes(std::span(&value, 1));
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  /// Appends a number with seven bits per byte, the lowest first: at most kMostCountBytes.
  static constexpr std::uint64_t kMostCountBytes = 10;
  void put_count(std::uint64_t value);
  void put_text(const std::string& text);
  void put_bytes(std::span<const std::byte> bytes);
  /// Makes room for a payload of so many bytes, so that it need not grow.
  void reserve(std::uint64_t payload_bytes);
  void clear();
  std::span<const std::byte> payload() const;

 private:
  friend class JournalWriter;
  std::vector<std::byte> bytes_;
};

/// A payload, read front to back. Reading beyond its end throws InputError.
class JournalPayload {
 public:
  /// place: where the record is in the file.
  JournalPayload(std::span<const std::byte> bytes, std::string where, std::uint64_t place = 0)
      : left_(bytes), where_(std::move(where)), place_(place) {}

  template <typename Value>
  requires std::is_trivially_copyable_v<Value> Value take() {
    Value value;
    std::memcpy(&value, take_bytes(sizeof value).data(), sizeof value);
    return value;
  }
  std::uint64_t take_count();
  std::string take_text();
  /// The next bytes, which belong to the payload.
  std::span<const std::byte> take_bytes(std::size_t bytes);
  bool at_end() const { return left_.empty(); }
  std::uint64_t place() const { return place_; }
  /// Throws InputError, which names file and record.
  [[noreturn]] void refuse(const std::string& what) const;

 private:
  std::span<const std::byte> left_;
  std::string where_;
  std::uint64_t place_;
};

/// Reads the payload of the record at a place of a journal's file into `bytes`. Throws InputError,
/// which names the place, where the record is damaged.
JournalPayload read_record(const File& file, std::uint64_t place, std::vector<std::byte>& bytes);

/// Reads and checks a journal to its end. A torn tail, records that were being written when the
/// process or the system died, is left out. Throws InputError, which names the record, where
/// anything else is wrong.
class JournalReader {
 public:
  explicit JournalReader(const std::filesystem::path& path);

  const std::string& name() const { return file_.name(); }
  /// The identity; nullopt where not even that was written, so that the journal is empty.
  const std::optional<JournalIdentity>& identity() const { return identity_; }
  const File& file() const { return file_; }
  /// Number of records without the identity.
  std::uint64_t records() const { return records_; }
  std::uint64_t whole_bytes() const { return whole_bytes_; }
  /// The torn record in words, as in "record 7 at byte 1234 is torn"; empty where there is none.
  const std::string& torn() const { return torn_; }

  /// Calls visit(payload) for all records but the identity, in the order in which they were
  /// appended.
  void for_each(const std::function<void(JournalPayload)>& visit) const;

 private:
  File file_;
  std::optional<JournalIdentity> identity_;
  std::uint64_t records_ = 0;
  std::uint64_t whole_bytes_ = 0;
  std::string torn_;
};

/// Appends records. Thread safe. An appended record survives the death of the process at once, and
/// that of the system after the next sync. The first append that comes `interval_seconds` after the
/// last sync makes one. Throws ResourceError, which names the file.
class JournalWriter {
 public:
  /// Creates a journal at a path where no file exists.
  static JournalWriter create(const std::filesystem::path& path, const JournalIdentity& identity,
                              double interval_seconds);
  /// Continues a journal after the records that were read, and cuts off a torn tail.
  static JournalWriter resume(const std::filesystem::path& path, const JournalReader& read,
                              double interval_seconds);
  JournalWriter(JournalWriter&&) noexcept;
  ~JournalWriter();

  /// Appends the record, which is empty afterwards, and returns its place in the file.
  std::uint64_t append(JournalRecord& record);
  void sync();

  const File& file() const;

 private:
  struct State;
  explicit JournalWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

// Format that the journal's writer and reader share (docs/design/journal.md).

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
