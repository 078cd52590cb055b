#include <algorithm>
#include <array>
#include <cstring>

#include "clearway/error.hpp"
#include "io/formats/byte_load.hpp"
#include "io/journal/journal_format.hpp"
#include "io/system/input_error.hpp"

namespace clearway {
namespace {

std::string place(std::uint64_t record, std::uint64_t position) {
  return "record " + std::to_string(record) + " at byte " + std::to_string(position);
}

void check_head(const File& file) {
  std::array<std::byte, kJournalHeadBytes> found;
  file.read_at(0, found);
  if (std::memcmp(found.data(), kJournalMagic, sizeof kJournalMagic) != 0) {
    refuse(file.name(), "not a journal, expected a file that 'clearway run' left unfinished");
  }
  if (const auto version = load<std::uint32_t>(found.data() + sizeof kJournalMagic);
      version != kJournalVersion) {
    refuse(file.name(), "journal format version " + std::to_string(version) + ", expected " +
                            std::to_string(kJournalVersion));
  }
  if (found != journal_head()) refuse(file.name(), "damaged: bytes 12 to 15 are not zero");
}

/// Reads the payload of a whole record at `position`; returns false where the record is not whole.
bool read_record(const File& file, std::uint64_t position, std::uint64_t size,
                 std::vector<std::byte>& payload) {
  if (size - position < sizeof(RecordHeader)) return false;
  RecordHeader header;
  file.read_at(position, std::as_writable_bytes(std::span(&header, 1)));
  const std::uint64_t left = size - position - sizeof header;
  if (!header.valid_at(position) || header.payload_bytes > left) return false;
  payload.resize(header.payload_bytes);
  file.read_at(position + sizeof header, payload);
  return xxh64(payload) == header.payload_xxh64;
}

/// How many bytes of the file were on the disk, according to the records whose headers lie from
/// `begin` on.
std::uint64_t synced_by_later(const File& file, std::uint64_t begin, std::uint64_t size) {
  constexpr std::uint64_t kPieceBytes = 1 << 20;
  std::uint64_t synced = 0;
  std::vector<std::byte> piece;
  for (std::uint64_t at = begin; at + sizeof(RecordHeader) <= size; at += kPieceBytes) {
    piece.resize(std::min(kPieceBytes + sizeof(RecordHeader) - 1, size - at));
    file.read_at(at, piece);
    for (std::size_t i = 0; i + sizeof(RecordHeader) <= piece.size(); ++i) {
      const auto header = load<RecordHeader>(piece.data() + i);
      if (header.valid_at(at + i)) synced = std::max(synced, header.synced_bytes);
    }
  }
  return synced;
}

JournalIdentity identity_of(JournalPayload payload) {
  JournalIdentity identity;
  while (!payload.at_end()) {
    std::string name = payload.take_text();
    identity.emplace_back(std::move(name), payload.take_text());
  }
  return identity;
}

}  // namespace

std::span<const std::byte> JournalPayload::take_bytes(std::size_t bytes) {
  if (bytes > left_.size()) refuse("it ends too early");
  const auto taken = left_.first(bytes);
  left_ = left_.subspan(bytes);
  return taken;
}

std::uint64_t JournalPayload::take_count() {
  std::uint64_t value = 0;
  for (unsigned shift = 0; shift < 64; shift += 7) {
    const auto byte = static_cast<std::uint64_t>(take<std::byte>());
    if (shift == 63 && byte > 1) break;
    value |= (byte & 0x7f) << shift;
    if (byte < 0x80) return value;
  }
  refuse("a number of more than 64 bits");
}

std::string JournalPayload::take_text() {
  const auto bytes = take_bytes(take_count());
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void JournalPayload::refuse(const std::string& what) const {
  throw InputError(where_ + ": " + what);
}

JournalReader::JournalReader(const std::filesystem::path& path) : file_(File::open_regular(path)) {
  const std::uint64_t size = file_.size_bytes();
  if (size < kJournalHeadBytes) {
    if (size > 0 && !is_journal(path)) refuse(name(), "not a journal, expected one");
    torn_ = "it ends before its first record";
    return;
  }
  check_head(file_);
  std::vector<std::byte> payload;
  std::uint64_t record = 0;
  whole_bytes_ = kJournalHeadBytes;
  for (; whole_bytes_ < size; ++record) {
    if (!read_record(file_, whole_bytes_, size, payload)) {
      const std::string where = place(record, whole_bytes_);
      if (synced_by_later(file_, whole_bytes_ + 1, size) > whole_bytes_) {
        refuse(name(), where + " is damaged: its hash is not that of its bytes");
      }
      torn_ = where + " is torn, with " + std::to_string(size - whole_bytes_) +
              " bytes from there to the end";
      break;
    }
    if (record == 0) identity_ = identity_of({payload, name() + ": " + place(0, whole_bytes_)});
    whole_bytes_ += sizeof(RecordHeader) + payload.size();
  }
  records_ = record - std::min<std::uint64_t>(record, 1);
}

void JournalReader::for_each(const std::function<void(JournalPayload)>& visit) const {
  std::vector<std::byte> payload;
  std::uint64_t record = 0;
  for (std::uint64_t at = kJournalHeadBytes; at < whole_bytes_; ++record) {
    const std::string where = name() + ": " + place(record, at);
    if (!read_record(file_, at, whole_bytes_, payload)) {
      throw InputError(where + " changed while it was read");
    }
    at += sizeof(RecordHeader) + payload.size();
    if (record > 0) visit({payload, where});
  }
}

}  // namespace clearway
