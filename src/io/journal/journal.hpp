#pragma once

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

#include "io/system/file.hpp"

/// The journal of an unfinished run: an append-only file of checksummed records
/// (docs/design/journal.md).
namespace clearway {

inline constexpr std::uint32_t kJournalVersion = 1;

/// What a journal belongs to, as named values in a fixed order.
using JournalIdentity = std::vector<std::pair<std::string, std::string>>;

/// The journal of an output: its name with ".journal" appended.
std::filesystem::path journal_of(const std::filesystem::path& output);

/// Whether there is a file that begins as a journal does.
bool is_journal(const std::filesystem::path& path);

/// What differs, in words, "radius is 0.2, expected 0.1"; empty where nothing does.
std::string difference(const JournalIdentity& found, const JournalIdentity& expected);

/// A record as it is made: its header's bytes first, then the payload.
class JournalRecord {
 public:
  JournalRecord() { clear(); }

  template <typename Value>
  requires std::is_trivially_copyable_v<Value>
  void put(const Value& value) {
    const auto bytes = std::as_bytes(std::span(&value, 1));
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  /// Seven bits a byte, the lowest first.
  void put_count(std::uint64_t value);
  void put_text(const std::string& text);
  void clear();

 private:
  friend class JournalWriter;
  std::vector<std::byte> bytes_;
};

/// A payload as it is read, front to back. What it does not hold throws InputError.
class JournalPayload {
 public:
  JournalPayload(std::span<const std::byte> bytes, std::string where)
      : left_(bytes), where_(std::move(where)) {}

  template <typename Value>
  requires std::is_trivially_copyable_v<Value> Value take() {
    Value value;
    std::memcpy(&value, take_bytes(sizeof value).data(), sizeof value);
    return value;
  }
  std::uint64_t take_count();
  std::string take_text();
  bool at_end() const { return left_.empty(); }
  /// Throws InputError naming file and record.
  [[noreturn]] void refuse(const std::string& what) const;

 private:
  std::span<const std::byte> take_bytes(std::size_t bytes);

  std::span<const std::byte> left_;
  std::string where_;
};

/// A journal read and checked to its end. A torn tail, records that were being written when the
/// process or the system died, is left out; InputError names the record where anything else is
/// wrong.
class JournalReader {
 public:
  explicit JournalReader(const std::filesystem::path& path);

  const std::string& name() const { return file_.name(); }
  /// None where not even that was written: nothing is in it.
  const std::optional<JournalIdentity>& identity() const { return identity_; }
  const File& file() const { return file_; }
  /// Records but the identity.
  std::uint64_t records() const { return records_; }
  std::uint64_t whole_bytes() const { return whole_bytes_; }
  /// "record 7 at byte 1234 is torn", empty where none is.
  const std::string& torn() const { return torn_; }

  /// In the order in which they were appended.
  void for_each(const std::function<void(JournalPayload)>& visit) const;

 private:
  File file_;
  std::optional<JournalIdentity> identity_;
  std::uint64_t records_ = 0;
  std::uint64_t whole_bytes_ = 0;
  std::string torn_;
};

/// Appends records. Thread safe. What was appended survives the death of the process at once, that
/// of the system after the next sync, which the first append makes that is `interval_seconds` after
/// the last. Throws ResourceError naming the file.
class JournalWriter {
 public:
  /// A new file; there is none of that name.
  static JournalWriter create(const std::filesystem::path& path, const JournalIdentity& identity,
                              double interval_seconds);
  /// Goes on after the records that were read; cuts off what is torn.
  static JournalWriter resume(const std::filesystem::path& path, const JournalReader& read,
                              double interval_seconds);
  JournalWriter(JournalWriter&&) noexcept;
  ~JournalWriter();

  /// The record is empty afterwards.
  void append(JournalRecord& record);
  void sync();

  const File& file() const;

 private:
  struct State;
  explicit JournalWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace clearway
