#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

#include "io/files/file.hpp"

namespace clearway {

static_assert(std::endian::native == std::endian::little, "file formats are read by memcpy");

/// Loads a little-endian number from any address, aligned or not.
template <typename Number>
Number load(const std::byte* bytes) {
  Number value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

/// Loads a big-endian number from any address, aligned or not.
template <typename Number>
Number load_swapped(const std::byte* bytes) {
  std::array<std::byte, sizeof(Number)> turned;
  for (std::size_t i = 0; i < turned.size(); ++i) turned[i] = bytes[turned.size() - 1 - i];
  return std::bit_cast<Number>(turned);
}

/// Appends little-endian values through a buffer to a file, front to back. The caller owns the
/// file; what is not flushed is lost. Throws ResourceError as File does.
class ByteWriter {
 public:
  static_assert(std::endian::native == std::endian::little);

  explicit ByteWriter(const File& file) : file_(file) { buffer_.reserve(kBufferBytes); }

  template <typename Value>
  requires std::is_trivially_copyable_v<Value>
  void put(const Value& value) { std::memcpy(room(sizeof value), &value, sizeof value); }

  /// Writes the first `bytes` bytes of the text, filled with zeros where it is shorter.
  void put_text(std::string_view text, std::size_t bytes) {
    for (std::size_t i = 0; i < bytes; ++i) put(i < text.size() ? text[i] : '\0');
  }

  void put_bytes(std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
      const std::size_t count = std::min(bytes.size(), kBufferBytes);
      std::memcpy(room(count), bytes.data(), count);
      bytes = bytes.subspan(count);
    }
  }

  void flush() {
    file_.write(std::as_bytes(std::span(buffer_)));
    buffer_.clear();
  }

 private:
  static constexpr std::size_t kBufferBytes = 1 << 20;

  /// Room in the buffer for `bytes` more bytes, at most kBufferBytes.
  std::byte* room(std::size_t bytes) {
    if (buffer_.size() + bytes > kBufferBytes) flush();
    buffer_.resize(buffer_.size() + bytes);
    return buffer_.data() + buffer_.size() - bytes;
  }

  const File& file_;
  std::vector<std::byte> buffer_;
};

}  // namespace clearway
