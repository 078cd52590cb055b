#pragma once

#include <sys/stat.h>

#include <array>
#include <cstdint>
#include <filesystem>

namespace clearway {

/// State of a file that differs once it was written to or another file has its name: the size in
/// bytes, and the times of the last change of its contents and of its status, in seconds and
/// nanoseconds. The inode's number is left out, because some network file systems assign a new one
/// to a file that nobody has open.
using FileState = std::array<std::int64_t, 5>;

/// The state of a file; all zero where it cannot be read.
inline FileState state_of(const std::filesystem::path& path) {
  struct stat found {};
  if (::stat(path.c_str(), &found) != 0) return {};
  return {found.st_size, found.st_mtim.tv_sec, found.st_mtim.tv_nsec, found.st_ctim.tv_sec,
          found.st_ctim.tv_nsec};
}

}  // namespace clearway
