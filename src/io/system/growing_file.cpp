#include "io/system/growing_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <system_error>
#include <utility>

namespace clearway {
namespace {

// Bytes that are reserved or written back at once.
constexpr std::uint64_t kPiece = std::uint64_t{64} << 20;
constexpr std::uint64_t kLeastFree = 16;  // pieces that must be free on the disk for reserving

}  // namespace

GrowingFile::GrowingFile(const std::filesystem::path& path)
    : folder_(folder_of(path)), file_(File::open_for_writing(path)) {}

GrowingFile::~GrowingFile() = default;

void GrowingFile::written(std::uint64_t end) {
  if (end < kPiece) return;
  reserve_ahead(end);
  {
    const std::lock_guard lock(mutex_);
    written_ = end;
  }
  if (may_write_back_ && !writing_back_.joinable()) {
    try {
      writing_back_ = std::jthread([this](const std::stop_token& stop) { write_back(stop); });
    } catch (const std::system_error&) {
      may_write_back_ = false;  // no thread is available, so the sync at the end does all of it
    }
  }
  grown_.notify_one();
}

void GrowingFile::reserve_ahead(std::uint64_t end) {
  while (may_reserve_ && reserved_ < end + kPiece / 2) {
    reserved_ = std::max(reserved_, end);
    may_reserve_ = free_disk_bytes(folder_) >= kLeastFree * kPiece &&
                   ::fallocate(file_.descriptor(), FALLOC_FL_KEEP_SIZE,
                               static_cast<off_t>(reserved_), static_cast<off_t>(kPiece)) == 0;
    reserved_ += kPiece;
  }
}

void GrowingFile::write_back(const std::stop_token& stop) {
  std::uint64_t begun = 0;
  std::unique_lock lock(mutex_);
  while (grown_.wait(lock, stop, [&] { return written_ >= begun + kPiece; })) {
    const std::uint64_t first = std::exchange(begun, written_);
    lock.unlock();
    ::sync_file_range(file_.descriptor(), static_cast<off_t>(first),
                      static_cast<off_t>(begun - first), SYNC_FILE_RANGE_WRITE);
    lock.lock();
    if (stop.stop_requested()) return;
  }
}

void GrowingFile::trim() {
  if (reserved_ == 0) return;
  // Truncating the file to its own size frees the blocks behind it. Where this fails they stay
  // reserved.
  if (::ftruncate(file_.descriptor(), static_cast<off_t>(file_.size_bytes())) != 0) return;
}

}  // namespace clearway
