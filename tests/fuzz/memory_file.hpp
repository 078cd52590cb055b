#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "core/error.hpp"
#include "io/file.hpp"

namespace clearway::test {

/// A file of these bytes in memory, with a name by which it can be opened.
class MemoryFile {
 public:
  explicit MemoryFile(std::span<const std::uint8_t> bytes)
      : file_(File::adopt(::memfd_create("input", MFD_CLOEXEC), "input")) {
    file_.write(std::as_bytes(bytes));
    file_.rewind();
  }

  std::filesystem::path path() const {
    return "/proc/self/fd/" + std::to_string(file_.descriptor());
  }
  const File& file() const { return file_; }
  /// Another owner, at the first byte.
  File open() const { return File::open_for_reading(path()); }

 private:
  File file_;
};

/// Runs `read`, which may refuse its input in the three ways that the program answers with an exit
/// code; anything else that it throws is a finding.
template <typename Read>
void may_refuse(Read read) {
  try {
    read();
  } catch (const Error&) {
  }
}

}  // namespace clearway::test
