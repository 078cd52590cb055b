#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

#include "io/system/file.hpp"

namespace clearway {

/// A read-only map of a whole file. Should the file shrink or fail under the map, the system sends
/// SIGBUS; install_map_fault_handler turns that into a message and exit code 4.
class MappedFile {
 public:
  explicit MappedFile(const std::filesystem::path& path);
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;
  ~MappedFile();

  const std::string& name() const { return file_.name(); }
  std::span<const std::byte> bytes() const { return bytes_; }
  /// The file itself, for reads that do not go through the map.
  const File& file() const { return file_; }

 private:
  File file_;
  std::span<const std::byte> bytes_;
};

/// For programs: a fault under any MappedFile prints its name to standard error and ends the
/// process with `exit_code`.
void install_map_fault_handler(int exit_code);

}  // namespace clearway
