#pragma once

#include <sys/stat.h>

#include <array>
#include <cstdint>
#include <filesystem>

namespace clearway {

/// What differs once a file was written to, or another one has its name: the size in bytes, and
/// the times of the last change of its contents and of its status, in seconds and nanoseconds. Not
/// the inode's number, which some network file systems give anew to a file that nobody has open.
using FileState = std::array<std::int64_t, 5>;

/// All zero where the file cannot be looked at.
inline FileState state_of(const std::filesystem::path& path) {
  struct stat found {};
  if (::stat(path.c_str(), &found) != 0) return {};
  return {found.st_size, found.st_mtim.tv_sec, found.st_mtim.tv_nsec, found.st_ctim.tv_sec,
          found.st_ctim.tv_nsec};
}

}  // namespace clearway
