#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <mutex>

#include "clearway/error.hpp"
#include "io/journal/journal_format.hpp"

namespace clearway {
namespace {

using SteadyClock = std::chrono::steady_clock;

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

struct JournalWriter::State {
  State(File opened, std::uint64_t bytes, double interval)
      : file(std::move(opened)), end(bytes), interval_seconds(interval) {}

  const File file;
  std::mutex mutex;
  std::mutex sync_mutex;  ///< taken before `mutex`
  std::uint64_t end;
  std::uint64_t synced = 0;
  bool named = false;  ///< whether the folder's entry is on the disk; guarded by sync_mutex
  /// Whether a write failed; records behind one that is not whole are never read.
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

const File& JournalWriter::file() const { return state_->file; }

void JournalWriter::append(JournalRecord& record) {
  State& s = *state_;
  const auto payload = std::span(record.bytes_).subspan(sizeof(RecordHeader));
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
    if (due) s.last_sync = SteadyClock::now();  // so that no other thread syncs too
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
