#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "io/files/file.hpp"

namespace clearway {

struct MapRecord;

/// A read-only map of a file or a part of it. If the file shrinks or fails under the map, the
/// system sends SIGBUS, which install_map_fault_handler() turns into a message and an exit code,
/// and survive_faults() into pages of zeros.
class MappedFile {
 public:
  explicit MappedFile(const std::filesystem::path& path);
  /// Maps a part of an open file, and reads it ahead.
  MappedFile(const File& file, std::uint64_t first, std::size_t count);
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;
  ~MappedFile();

  const std::string& name() const { return file_.name(); }
  std::span<const std::byte> bytes() const { return bytes_; }
  /// The file itself, for reads that do not go through the map.
  const File& file() const { return file_; }

  /// From now on, what can no longer be read is zeros, and failed() says so: for programs that go
  /// on without the file. Installs a handler of SIGBUS, which passes on what does not concern a
  /// map. Source of the idea: libwayland's access to shared memory.
  void survive_faults() const;
  /// Whether something of the file could not be read, so that what was read may be zeros.
  bool failed() const;

 private:
  void map(std::uint64_t first, std::size_t count, int flags);

  File file_;
  std::span<const std::byte> map_;    ///< begins with a page
  std::span<const std::byte> bytes_;  ///< what was asked for of it
  MapRecord* record_ = nullptr;
};

/// Makes a fault under any MappedFile print the file's name to standard error and end the process
/// with `exit_code`. Only for programs, not for libraries.
void install_map_fault_handler(int exit_code);

}  // namespace clearway
