#pragma once

#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <span>
#include <string>

#include "clearway/error.hpp"
#include "io/files/file.hpp"

namespace clearway::test {

using Bytes = std::span<const std::uint8_t>;

/// What fuzz_NAME does with any bytes.
using Targets = std::map<std::string, void (*)(Bytes)>;

/// The targets of the program.
inline Targets& targets() {
  static Targets all;
  return all;
}

inline bool add_targets(Targets more) {
  targets().merge(more);
  return true;
}

inline void require(bool condition) {
  if (!condition) std::abort();
}

/// A file of given bytes, in memory where the system has a folder for that. Only one may exist at a
/// time.
class MemoryFile {
 public:
  explicit MemoryFile(Bytes bytes) { File::create(path_).write(std::as_bytes(bytes)); }
  explicit MemoryFile(const std::string& bytes)
      : MemoryFile({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}) {}
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  ~MemoryFile() { ::unlink(path_.c_str()); }

  const std::filesystem::path& path() const { return path_; }
  /// The file, opened for reading at its first byte.
  File open() const { return File::open_for_reading(path_); }

 private:
  static std::filesystem::path folder() {
    const std::filesystem::path shared = "/dev/shm";
    return std::filesystem::is_directory(shared) ? shared : std::filesystem::temp_directory_path();
  }

  std::filesystem::path path_ = folder() / ("clearway-fuzz-" + std::to_string(::getpid()));
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

inline std::string text_of(Bytes bytes) { return {bytes.begin(), bytes.end()}; }

}  // namespace clearway::test
