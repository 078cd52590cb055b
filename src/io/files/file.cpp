#include "io/files/file.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <utility>

#include "clearway/error.hpp"
#include "core/util/format.hpp"

namespace clearway {
namespace {

[[noreturn]] void fail(const std::string& name, const char* what) {
  throw system_failure(name + ": cannot " + what, errno);
}

int checked_open(const std::filesystem::path& path, int flags, const char* what) {
  int descriptor;
  do {
    descriptor = ::open(path.c_str(), flags | O_CLOEXEC, 0666);
  } while (descriptor < 0 && errno == EINTR);
  if (descriptor < 0) fail(path.string(), what);
  return descriptor;
}

struct stat status_of(int descriptor, const std::string& name) {
  struct stat status {};
  if (::fstat(descriptor, &status) != 0) fail(name, "read the status");
  return status;
}

/// Number of bytes free for this user.
std::uint64_t free_bytes(const struct statvfs& disk) {
  return static_cast<std::uint64_t>(disk.f_bavail) * disk.f_frsize;
}

/// Such as "reserve 8,192 bytes, 4,096 of which are missing".
std::string reserve_text(int descriptor, std::uint64_t bytes) {
  const std::string text = "reserve " + format_count(bytes) + " bytes";
  struct statvfs disk {};
  struct stat status {};
  if (::fstatvfs(descriptor, &disk) != 0 || ::fstat(descriptor, &status) != 0) return text;
  constexpr std::uint64_t kBlock = 512;  // the unit of st_blocks
  const std::uint64_t there =
      free_bytes(disk) + static_cast<std::uint64_t>(status.st_blocks) * kBlock;
  if (bytes <= there) return text;
  return text + ", " + format_count(bytes - there) + " of which are missing";
}

}  // namespace

ResourceError system_failure(const std::string& what, int error) {
  const bool full = error == ENOSPC || error == EDQUOT;
  return ResourceError(what + ": " + std::strerror(error),
                       full ? Remedy::kFreeDisk : Remedy::kNone);
}

File File::open_for_reading(const std::filesystem::path& path) {
  File file(checked_open(path, O_RDONLY, "open"), path.string());
  if (S_ISDIR(status_of(file.descriptor_, file.name_).st_mode)) {
    throw ResourceError(path.string() + ": is a directory, expected a file");
  }
  return file;
}

File File::open_regular(const std::filesystem::path& path) {
  File file(checked_open(path, O_RDONLY | O_NONBLOCK, "open"), path.string());
  if (!file.is_regular()) {
    throw ResourceError(path.string() + ": is a directory, pipe or device, expected a file");
  }
  return file;
}

File File::open_for_writing(const std::filesystem::path& path) {
  return {checked_open(path, O_RDWR | O_NOFOLLOW, "open"), path.string()};
}

File File::create(const std::filesystem::path& path) {
  return {checked_open(path, O_RDWR | O_CREAT | O_TRUNC | O_NOFOLLOW, "create"), path.string()};
}

File File::create_temporary(const std::filesystem::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (descriptor >= 0) return {descriptor, folder.string() + " (temporary file)"};
  // For file systems without O_TMPFILE.
  std::string pattern = (folder / ".clearway-XXXXXX").string();
  const int named = ::mkostemp(pattern.data(), O_CLOEXEC);
  if (named < 0) fail(folder.string(), "create a temporary file in it");
  ::unlink(pattern.c_str());
  return {named, folder.string() + " (temporary file)"};
}

File File::adopt(int descriptor, std::string name) { return {descriptor, std::move(name)}; }

File::File(File&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), name_(std::move(other.name_)) {}

File& File::operator=(File&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(name_, other.name_);
  return *this;
}

File::~File() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

std::uint64_t File::size_bytes() const {
  return static_cast<std::uint64_t>(status_of(descriptor_, name_).st_size);
}

File::Stamp File::stamp() const {
  const struct stat status = status_of(descriptor_, name_);
  return {static_cast<std::uint64_t>(status.st_size), status.st_mtim.tv_sec,
          status.st_mtim.tv_nsec};
}

bool File::is_regular() const { return S_ISREG(status_of(descriptor_, name_).st_mode); }

namespace {

bool are_same(const struct stat& a, const struct stat& b) {
  return a.st_ino == b.st_ino && a.st_dev == b.st_dev;
}

}  // namespace

bool File::is_at(const std::filesystem::path& path) const {
  struct stat named {};
  return ::lstat(path.c_str(), &named) == 0 && are_same(status_of(descriptor_, name_), named);
}

bool File::is_reached_by(const std::filesystem::path& path) const {
  struct stat reached {};
  return ::stat(path.c_str(), &reached) == 0 && are_same(status_of(descriptor_, name_), reached);
}

std::uint64_t File::names() const { return status_of(descriptor_, name_).st_nlink; }

void File::read_at(std::uint64_t offset, std::span<std::byte> out) const {
  while (!out.empty()) {
    const ssize_t got = ::pread(descriptor_, out.data(), out.size(), static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail(name_, "read");
    if (got == 0) {
      throw ResourceError(name_ + ": ends at byte " + std::to_string(offset) + ", expected " +
                          std::to_string(out.size()) + " more bytes; it shrank while it was read");
    }
    offset += static_cast<std::uint64_t>(got);
    out = out.subspan(static_cast<std::size_t>(got));
  }
}

std::size_t File::read_some(std::span<std::byte> out) const {
  for (;;) {
    const ssize_t got = ::read(descriptor_, out.data(), out.size());
    if (got >= 0) return static_cast<std::size_t>(got);
    if (errno != EINTR) fail(name_, "read");
  }
}

void File::write_at(std::uint64_t offset, std::span<const std::byte> bytes) const {
  while (!bytes.empty()) {
    const ssize_t put =
        ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) fail(name_, "write");
    offset += static_cast<std::uint64_t>(put);
    bytes = bytes.subspan(static_cast<std::size_t>(put));
  }
}

void File::write(std::span<const std::byte> bytes) const {
  while (!bytes.empty()) {
    const ssize_t put = ::write(descriptor_, bytes.data(), bytes.size());
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) fail(name_, "write");
    bytes = bytes.subspan(static_cast<std::size_t>(put));
  }
}

void File::rewind() const {
  if (::lseek(descriptor_, 0, SEEK_SET) < 0) fail(name_, "seek");
}

void File::reserve(std::uint64_t bytes) const {
  if (bytes == 0) return;
  int error;
  do {
    error = ::posix_fallocate(descriptor_, 0, static_cast<off_t>(bytes));
  } while (error == EINTR);
  if (error == 0) return;
  throw system_failure(name_ + ": cannot " + reserve_text(descriptor_, bytes), error);
}

void File::reserve_ahead(std::uint64_t bytes) const {
  if (bytes == 0) return;
  while (::fallocate(descriptor_, FALLOC_FL_KEEP_SIZE, 0, static_cast<off_t>(bytes)) != 0) {
    if (errno == EINTR) continue;
    if (errno != ENOSPC && errno != EDQUOT && errno != EFBIG) return;
    const int error = errno;
    throw system_failure(name_ + ": cannot " + reserve_text(descriptor_, bytes), error);
  }
}

void File::truncate(std::uint64_t bytes) const {
  while (::ftruncate(descriptor_, static_cast<off_t>(bytes)) != 0) {
    if (errno != EINTR) fail(name_, "truncate");
  }
}

void File::begin_sync(std::uint64_t offset, std::uint64_t bytes) const {
  // A failure here is ignored, because it occurs again where the sync is waited for.
  ::sync_file_range(descriptor_, static_cast<off_t>(offset), static_cast<off_t>(bytes),
                    SYNC_FILE_RANGE_WRITE);
}

void File::sync() const {
  while (::fsync(descriptor_) != 0) {
    if (errno != EINTR) fail(name_, "sync");
  }
}

std::filesystem::path folder_of(const std::filesystem::path& path) {
  return path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
}

std::uint64_t free_disk_bytes(const std::filesystem::path& folder) {
  struct statvfs status {};
  if (::statvfs(folder.c_str(), &status) != 0) fail(folder.string(), "ask for free space");
  return free_bytes(status);
}

namespace {

struct flock whole_file() {
  struct flock whole {};
  whole.l_type = F_WRLCK;
  whole.l_whence = SEEK_SET;
  return whole;
}

}  // namespace

bool lock_whole(const File& file) {
  struct flock whole = whole_file();
  return ::fcntl(file.descriptor(), F_OFD_SETLK, &whole) == 0 ||
         (errno != EAGAIN && errno != EACCES);
}

LockState lock_state(const File& file) {
  struct flock whole = whole_file();
  if (::fcntl(file.descriptor(), F_OFD_GETLK, &whole) != 0) return LockState::kUnknown;
  return whole.l_type == F_UNLCK ? LockState::kFree : LockState::kHeld;
}

namespace {

/// Files for outputs, libraries and brief use.
constexpr std::uint64_t kSpare = 16;

std::uint64_t open_files() {
  std::error_code unknown;
  const std::filesystem::directory_iterator files("/proc/self/fd", unknown);
  if (unknown) return kSpare;
  return static_cast<std::uint64_t>(std::distance(begin(files), end(files)));
}

}  // namespace

std::uint64_t needed_open_files(std::uint64_t more) { return open_files() + more + kSpare; }

void require_open_files(std::uint64_t more, const std::string& purpose) {
  rlimit limit{};
  const std::uint64_t needed = needed_open_files(more);
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur >= needed) return;
  throw ResourceError(purpose + " needs " + std::to_string(needed) +
                      " open files, and this process may open " + std::to_string(limit.rlim_cur) +
                      "; ulimit -n " + std::to_string(needed) + " allows them");
}

void raise_open_files_limit(std::uint64_t more) {
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  const rlim_t wanted = std::min<rlim_t>(needed_open_files(more) + kSpare, limit.rlim_max);
  if (wanted <= limit.rlim_cur) return;
  limit.rlim_cur = wanted;
  // A failure is ignored, as require_open_files() reports it later.
  ::setrlimit(RLIMIT_NOFILE, &limit);
}

}  // namespace clearway
