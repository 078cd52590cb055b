#pragma once

#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string>

#include "io/files/file.hpp"

namespace clearway::test {

/// The bytes that a writer wrote to a nameless file.
class WrittenBytes {
 public:
  explicit WrittenBytes(const File& file) : bytes_(file.size_bytes(), '\0') {
    file.read_at(0, std::as_writable_bytes(std::span(bytes_)));
  }

  const std::string& all() const { return bytes_; }
  std::size_t size() const { return bytes_.size(); }

  template <typename Value>
  Value at(std::size_t offset) const {
    Value value;
    if (offset + sizeof value > bytes_.size()) throw std::out_of_range("beyond the written bytes");
    std::memcpy(&value, bytes_.data() + offset, sizeof value);
    return value;
  }
  /// The number of so many bytes, the lowest first.
  std::uint64_t number(std::size_t offset, unsigned bytes) const {
    std::uint64_t value = 0;
    std::memcpy(&value, bytes_.substr(offset, bytes).data(), bytes);
    return value;
  }
  /// The text at `offset`, up to the first zero byte and at most `bytes` long.
  std::string text(std::size_t offset, std::size_t bytes) const {
    const std::string part = bytes_.substr(offset, bytes);
    return part.substr(0, part.find('\0'));
  }
  bool zero(std::size_t offset, std::size_t bytes) const {
    return bytes_.substr(offset, bytes) == std::string(bytes, '\0');
  }

 private:
  std::string bytes_;
};

inline File nameless_file() {
  return File::create_temporary(std::filesystem::temp_directory_path());
}

}  // namespace clearway::test
