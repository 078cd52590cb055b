#pragma once

#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <stop_token>
#include <thread>

#include "io/system/file.hpp"

namespace clearway {

/// Speeds up the writing of a large file that someone else writes front to back. Space is reserved
/// ahead of the writer, which makes each write cheaper, and written bytes are sent to the disk
/// meanwhile, so that the last sync is short. Failures here are ignored; the writer and the sync
/// meet them.
class GrowingFile {
 public:
  explicit GrowingFile(const std::filesystem::path& path);
  ~GrowingFile();
  GrowingFile(const GrowingFile&) = delete;
  GrowingFile& operator=(const GrowingFile&) = delete;

  /// Reports that all bytes before `end` are written.
  void written(std::uint64_t end);
  /// Frees what was reserved behind the end of the file, which is complete now.
  void trim();

 private:
  void reserve_ahead(std::uint64_t end);
  void write_back(const std::stop_token& stop);

  std::filesystem::path folder_;
  File file_;
  std::uint64_t reserved_ = 0;
  bool may_reserve_ = true, may_write_back_ = true;
  std::mutex mutex_;
  std::condition_variable_any grown_;
  std::uint64_t written_ = 0;  // guarded by mutex_
  std::jthread writing_back_;  // starts with the first large piece; must be the last member
};

}  // namespace clearway
