#include "io/result/journal.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <mutex>

#include "clearway/error.hpp"
#include "io/files/bytes.hpp"
#include "io/files/input_error.hpp"

namespace clearway {

std::filesystem::path journal_of(const std::filesystem::path& output) {
  return output.string() + ".journal";
}

bool is_journal(const std::filesystem::path& path) {
  std::error_code unknown;
  if (!std::filesystem::is_regular_file(path, unknown)) return false;
  const File file = File::open_regular(path);
  std::array<std::byte, sizeof kJournalMagic> found;
  const std::size_t bytes = std::min<std::uint64_t>(file.size_bytes(), found.size());
  file.read_at(0, std::span(found).first(bytes));
  return bytes > 0 && std::memcmp(found.data(), kJournalMagic, bytes) == 0;
}

std::string difference(const JournalIdentity& found, const JournalIdentity& expected) {
  const auto value_in = [](const JournalIdentity& identity, const std::string& name) {
    for (const auto& [field, value] : identity) {
      if (field == name) return value;
    }
    return std::string("missing");
  };
  std::string text;
  const auto add = [&text](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  for (const auto& [name, value] : expected) {
    const std::string other = value_in(found, name);
    if (other != value) add(name + " is " + other + ", expected " + value);
  }
  for (const auto& [name, value] : found) {
    if (value_in(expected, name) == "missing") add(name + " is " + value + ", expected none");
  }
  return text;
}

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
    refuse(file.name(), "is a journal of version " + std::to_string(version) +
                            " of another release; run it again");
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

JournalPayload read_record(const File& file, std::uint64_t place, std::vector<std::byte>& bytes) {
  const std::string where = file.name() + ": the record at byte " + std::to_string(place);
  if (!read_record(file, place, file.size_bytes(), bytes)) {
    throw InputError(where + " was changed while the run was under way");
  }
  return {bytes, where, place};
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
    if (record > 0) visit({payload, where, at});
    at += sizeof(RecordHeader) + payload.size();
  }
}

namespace {

using SteadyClock = std::chrono::steady_clock;

File open_to_append(const std::filesystem::path& path, int flags) {
  int descriptor;
  do {
    descriptor = ::open(path.c_str(), flags | O_RDWR | O_CLOEXEC | O_NOFOLLOW, 0666);
  } while (descriptor < 0 && errno == EINTR);
  if (descriptor < 0) {
    throw system_failure(path.string() + ": cannot open the journal", errno);
  }
  return File::adopt(descriptor, path.string());
}

void sync_folder_of(const std::filesystem::path& path) {
  const std::filesystem::path folder = folder_of(path);
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) {
    throw system_failure(folder.string() + ": cannot open", errno);
  }
  File::adopt(descriptor, folder.string()).sync();
}

}  // namespace

void JournalRecord::reserve(std::uint64_t payload_bytes) {
  bytes_.reserve(sizeof(RecordHeader) + payload_bytes);
}

void JournalRecord::clear() { bytes_.assign(sizeof(RecordHeader), std::byte{0}); }

std::span<const std::byte> JournalRecord::payload() const {
  return std::span(bytes_).subspan(sizeof(RecordHeader));
}

void JournalRecord::put_count(std::uint64_t value) {
  for (; value >= 0x80; value >>= 7) bytes_.push_back(static_cast<std::byte>(value | 0x80));
  bytes_.push_back(static_cast<std::byte>(value));
}

void JournalRecord::put_text(const std::string& text) {
  put_count(text.size());
  put_bytes(std::as_bytes(std::span(text)));
}

void JournalRecord::put_bytes(std::span<const std::byte> bytes) {
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
}

struct JournalWriter::State {
  State(File opened, std::uint64_t bytes, double interval)
      : file(std::move(opened)), end(bytes), interval_seconds(interval) {}

  const File file;
  std::mutex mutex;
  std::mutex sync_mutex;  ///< taken before `mutex`
  std::uint64_t end;
  std::uint64_t synced = 0;
  bool named = false;  ///< whether the folder's entry is on the disk; guarded by sync_mutex
  /// Whether a write failed; records after one that is not whole are never read.
  bool failed = false;
  SteadyClock::time_point last_sync = SteadyClock::now();
  double interval_seconds;
};

JournalWriter::JournalWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
JournalWriter::JournalWriter(JournalWriter&&) noexcept = default;
JournalWriter::~JournalWriter() = default;

JournalWriter JournalWriter::create(const std::filesystem::path& path,
                                    const JournalIdentity& identity, double interval_seconds) {
  File file = open_to_append(path, O_CREAT | O_EXCL);
  file.write_at(0, journal_head());
  JournalWriter writer(
      std::make_unique<State>(std::move(file), kJournalHeadBytes, interval_seconds));
  JournalRecord record;
  for (const auto& [name, value] : identity) {
    record.put_text(name);
    record.put_text(value);
  }
  writer.append(record);
  return writer;
}

JournalWriter JournalWriter::resume(const std::filesystem::path& path, const JournalReader& read,
                                    double interval_seconds) {
  File file = open_to_append(path, 0);
  file.truncate(read.whole_bytes());
  return JournalWriter(
      std::make_unique<State>(std::move(file), read.whole_bytes(), interval_seconds));
}

const File& JournalWriter::file() const { return state_->file; }

std::uint64_t JournalWriter::append(JournalRecord& record) {
  State& s = *state_;
  const std::span<const std::byte> payload = record.payload();
  if (payload.size() > kMostPayloadBytes) {
    throw ResourceError(s.file.name() + ": a record of " + std::to_string(payload.size()) +
                        " bytes, expected fewer than 2^32");
  }
  RecordHeader header{.mark = kRecordMark,
                      .payload_bytes = static_cast<std::uint32_t>(payload.size()),
                      .synced_bytes = 0,
                      .payload_xxh64 = xxh64(payload),
                      .header_xxh64 = 0};
  bool due;
  std::uint64_t place;
  {
    const std::lock_guard lock(s.mutex);
    if (s.failed) throw ResourceError(s.file.name() + ": cannot write after a failure");
    header.synced_bytes = s.synced;
    header.header_xxh64 = header.hash_at(s.end);
    std::memcpy(record.bytes_.data(), &header, sizeof header);
    s.failed = true;
    s.file.write_at(s.end, record.bytes_);
    s.failed = false;
    place = s.end;
    s.end += record.bytes_.size();
    due = std::chrono::duration<double>(SteadyClock::now() - s.last_sync).count() >=
          s.interval_seconds;
    if (due) s.last_sync = SteadyClock::now();  // so that no other thread syncs too
  }
  record.clear();
  if (due) sync();
  return place;
}

void JournalWriter::sync() {
  State& s = *state_;
  const std::lock_guard one_at_a_time(s.sync_mutex);
  std::uint64_t end;
  {
    const std::lock_guard lock(s.mutex);
    end = s.end;
  }
  s.file.sync();
  if (!s.named) sync_folder_of(s.file.name());
  s.named = true;
  const std::lock_guard lock(s.mutex);
  s.synced = end;
  s.last_sync = SteadyClock::now();
}

}  // namespace clearway
