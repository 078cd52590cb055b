#include "io/journal.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <mutex>

#include "core/error.hpp"
#include "io/byte_load.hpp"
#include "io/xxh64.hpp"

namespace clearway {
namespace {

using SteadyClock = std::chrono::steady_clock;

constexpr char kMagic[8] = {'C', 'L', 'W', 'Y', 'J', 'R', 'N', 'L'};
constexpr std::uint64_t kHeadBytes = 16;  // magic, version, 4 zero bytes
constexpr std::uint32_t kMark = 0x43525743;
constexpr std::uint64_t kMostPayloadBytes = 0xffffffff;

/// Before every payload.
struct RecordHeader {
  std::uint32_t mark;
  std::uint32_t payload_bytes;
  std::uint64_t synced_bytes;  ///< of the file, known to be on the disk when this was written
  std::uint64_t payload_xxh64;
  std::uint64_t header_xxh64;  ///< of the record's position and the 24 bytes before

  std::uint64_t hash_at(std::uint64_t position) const {
    const std::uint64_t parts[4] = {position, mark | std::uint64_t{payload_bytes} << 32,
                                    synced_bytes, payload_xxh64};
    return xxh64(std::as_bytes(std::span(parts)));
  }
  bool valid_at(std::uint64_t position) const {
    return mark == kMark && header_xxh64 == hash_at(position);
  }
};
static_assert(sizeof(RecordHeader) == 32);

std::array<std::byte, kHeadBytes> head() {
  std::array<std::byte, kHeadBytes> bytes{};
  std::memcpy(bytes.data(), kMagic, sizeof kMagic);
  std::memcpy(bytes.data() + sizeof kMagic, &kJournalVersion, sizeof kJournalVersion);
  return bytes;
}

[[noreturn]] void refuse(const std::string& name, const std::string& what) {
  throw InputError(name + ": " + what);
}

std::string place(std::uint64_t record, std::uint64_t position) {
  return "record " + std::to_string(record) + " at byte " + std::to_string(position);
}

void check_head(const File& file) {
  std::array<std::byte, kHeadBytes> found;
  file.read_at(0, found);
  if (std::memcmp(found.data(), kMagic, sizeof kMagic) != 0) {
    refuse(file.name(), "not a journal, expected a file that 'clearway run' left unfinished");
  }
  if (const auto version = load<std::uint32_t>(found.data() + sizeof kMagic);
      version != kJournalVersion) {
    refuse(file.name(), "journal format version " + std::to_string(version) + ", expected " +
                            std::to_string(kJournalVersion));
  }
  if (found != head()) refuse(file.name(), "damaged: bytes 12 to 15 are not zero");
}

/// The payload of a whole record at `position`; none where it is not whole.
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

/// How much of the file the records whose headers lie from `begin` on say was on the disk.
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

File open_to_append(const std::filesystem::path& path, int flags) {
  int descriptor;
  do {
    descriptor = ::open(path.c_str(), flags | O_RDWR | O_CLOEXEC | O_NOFOLLOW, 0666);
  } while (descriptor < 0 && errno == EINTR);
  if (descriptor < 0) {
    throw ResourceError(path.string() + ": cannot open the journal: " + std::strerror(errno));
  }
  return File::adopt(descriptor, path.string());
}

void sync_folder_of(const std::filesystem::path& path) {
  const std::filesystem::path folder = folder_of(path);
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) {
    throw ResourceError(folder.string() + ": cannot open: " + std::strerror(errno));
  }
  File::adopt(descriptor, folder.string()).sync();
}

}  // namespace

std::filesystem::path journal_of(const std::filesystem::path& output) {
  return output.string() + ".journal";
}

bool is_journal(const std::filesystem::path& path) {
  std::error_code unknown;
  if (!std::filesystem::is_regular_file(path, unknown)) return false;
  const File file = File::open_for_reading(path);
  std::array<std::byte, sizeof kMagic> found;
  const std::size_t bytes = std::min<std::uint64_t>(file.size_bytes(), found.size());
  file.read_at(0, std::span(found).first(bytes));
  return bytes > 0 && std::memcmp(found.data(), kMagic, bytes) == 0;
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

// ---- records

void JournalRecord::clear() { bytes_.assign(sizeof(RecordHeader), std::byte{0}); }

void JournalRecord::put_count(std::uint64_t value) {
  for (; value >= 0x80; value >>= 7) bytes_.push_back(static_cast<std::byte>(value | 0x80));
  bytes_.push_back(static_cast<std::byte>(value));
}

void JournalRecord::put_text(const std::string& text) {
  put_count(text.size());
  const auto bytes = std::as_bytes(std::span(text));
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
}

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

// ---- reader

JournalReader::JournalReader(const std::filesystem::path& path)
    : file_(File::open_for_reading(path)) {
  const std::uint64_t size = file_.size_bytes();
  if (size < kHeadBytes) {
    if (size > 0 && !is_journal(path)) refuse(name(), "not a journal, expected one");
    torn_ = "it ends before its first record";
    return;
  }
  check_head(file_);
  std::vector<std::byte> payload;
  std::uint64_t record = 0;
  whole_bytes_ = kHeadBytes;
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
  for (std::uint64_t at = kHeadBytes; at < whole_bytes_; ++record) {
    const std::string where = name() + ": " + place(record, at);
    if (!read_record(file_, at, whole_bytes_, payload)) {
      throw InputError(where + " changed while it was read");
    }
    at += sizeof(RecordHeader) + payload.size();
    if (record > 0) visit({payload, where});
  }
}

// ---- writer

struct JournalWriter::State {
  State(File opened, std::uint64_t bytes, double interval)
      : file(std::move(opened)), end(bytes), interval_seconds(interval) {}

  const File file;
  std::mutex mutex;
  std::mutex sync_mutex;  ///< taken before `mutex`
  std::uint64_t end;
  std::uint64_t synced = 0;
  bool named = false;   ///< the folder's entry is on the disk; of sync_mutex
  bool failed = false;  ///< what follows a record that was not written whole is never read
  SteadyClock::time_point last_sync = SteadyClock::now();
  double interval_seconds;
};

JournalWriter::JournalWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
JournalWriter::JournalWriter(JournalWriter&&) noexcept = default;
JournalWriter::~JournalWriter() = default;

JournalWriter JournalWriter::create(const std::filesystem::path& path,
                                    const JournalIdentity& identity, double interval_seconds) {
  File file = open_to_append(path, O_CREAT | O_EXCL);
  file.write_at(0, head());
  JournalWriter writer(std::make_unique<State>(std::move(file), kHeadBytes, interval_seconds));
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
  int failed;
  do {
    failed = ::ftruncate(file.descriptor(), static_cast<off_t>(read.whole_bytes()));
  } while (failed != 0 && errno == EINTR);
  if (failed != 0) {
    throw ResourceError(path.string() + ": cannot cut off what is torn: " + std::strerror(errno));
  }
  return JournalWriter(
      std::make_unique<State>(std::move(file), read.whole_bytes(), interval_seconds));
}

void JournalWriter::append(JournalRecord& record) {
  State& s = *state_;
  const auto payload = std::span(record.bytes_).subspan(sizeof(RecordHeader));
  if (payload.size() > kMostPayloadBytes) {
    throw ResourceError(s.file.name() + ": a record of " + std::to_string(payload.size()) +
                        " bytes, expected fewer than 2^32");
  }
  RecordHeader header{.mark = kMark,
                      .payload_bytes = static_cast<std::uint32_t>(payload.size()),
                      .synced_bytes = 0,
                      .payload_xxh64 = xxh64(payload),
                      .header_xxh64 = 0};
  bool due;
  {
    const std::lock_guard lock(s.mutex);
    if (s.failed) throw ResourceError(s.file.name() + ": cannot write after a failure");
    header.synced_bytes = s.synced;
    header.header_xxh64 = header.hash_at(s.end);
    std::memcpy(record.bytes_.data(), &header, sizeof header);
    s.failed = true;
    s.file.write_at(s.end, record.bytes_);
    s.failed = false;
    s.end += record.bytes_.size();
    due = std::chrono::duration<double>(SteadyClock::now() - s.last_sync).count() >=
          s.interval_seconds;
    if (due) s.last_sync = SteadyClock::now();  // nobody else needs to
  }
  record.clear();
  if (due) sync();
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
