#pragma once

#include <cstddef>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "io/files/file.hpp"

namespace clearway::test {

/// The bytes that a writer wrote to a nameless file.
class WrittenBytes {
 public:
  explicit WrittenBytes(const File& file) : bytes_(file.size_bytes()) { file.read_at(0, bytes_); }

  std::size_t size() const { return bytes_.size(); }

  template <typename Value>
  Value at(std::size_t offset) const {
    Value value;
    if (offset + sizeof value > bytes_.size()) throw std::out_of_range("beyond the written bytes");
    std::memcpy(&value, bytes_.data() + offset, sizeof value);
    return value;
  }

  /// The text at `offset`, up to the first zero byte and at most `bytes` long.
  std::string text(std::size_t offset, std::size_t bytes) const {
    std::string out;
    for (std::size_t i = 0; i < bytes && at<char>(offset + i) != '\0'; ++i) {
      out += at<char>(offset + i);
    }
    return out;
  }

  bool zero(std::size_t offset, std::size_t bytes) const {
    for (std::size_t i = 0; i < bytes; ++i) {
      if (at<char>(offset + i) != '\0') return false;
    }
    return true;
  }

 private:
  std::vector<std::byte> bytes_;
};

inline File nameless_file() {
  return File::create_temporary(std::filesystem::temp_directory_path());
}

}  // namespace clearway::test
