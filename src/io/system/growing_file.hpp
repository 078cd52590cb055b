#pragma once

#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <stop_token>
#include <thread>

#include "io/system/file.hpp"

namespace clearway {

/// Eases the growth of a large file that someone else writes front to back: space is reserved ahead
/// of the writer, which makes each write cheaper, and what is written goes to the disk meanwhile,
/// so that the last sync is short. Nothing depends on it: what fails here is left to the writer and
/// to the sync.
class GrowingFile {
 public:
  explicit GrowingFile(const std::filesystem::path& path);
  ~GrowingFile();
  GrowingFile(const GrowingFile&) = delete;
  GrowingFile& operator=(const GrowingFile&) = delete;

  /// All bytes before `end` are written.
  void written(std::uint64_t end);
  /// Gives back what was reserved behind the end of the file, which is written now.
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
  std::jthread writing_back_;  // begins with the first large piece; the last member
};

}  // namespace clearway
