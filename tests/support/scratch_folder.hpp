#pragma once

#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

namespace clearway::test {

/// A temporary folder that is removed when its owner ends.
class ScratchFolder {
 public:
  ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  ~ScratchFolder();

  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& folder() const { return path_; }

  /// Writes a new file of that name, in place of an old one, and returns its path.
  std::filesystem::path write(const std::string& name, std::string_view bytes) const;

 private:
  std::filesystem::path path_;
};

std::string bytes_of(const std::filesystem::path& path);

/// The value that starts at a byte. Throws std::out_of_range beyond the last.
template <typename Value>
Value value_at(std::string_view bytes, std::size_t at) {
  if (bytes.size() < at + sizeof(Value)) throw std::out_of_range("beyond the last byte");
  Value value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

/// Replaces the bytes of a file. An existing file is written in place, because a file that was cut
/// to nothing goes to the disk as soon as it is closed, which takes hundreds of times as long.
void put_bytes(const std::filesystem::path& path, const std::string& bytes);

}  // namespace clearway::test
