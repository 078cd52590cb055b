#pragma once

#include <array>
#include <charconv>
#include <concepts>
#include <cstddef>
#include <string>
#include <string_view>

#include "io/system/file.hpp"

namespace clearway {

/// Text appended through a buffer to a file. A double becomes the shortest digits that give it
/// back. The file stays the caller's; what was not flushed is lost. Throws ResourceError as File
/// does.
class TextWriter {
 public:
  explicit TextWriter(const File& file) : file_(file) { buffer_.reserve(kBufferBytes); }

  TextWriter& operator<<(std::string_view text) {
    if (buffer_.size() + text.size() > kBufferBytes) flush();
    buffer_ += text;
    return *this;
  }

  template <typename Number>
  requires std::integral<Number> || std::floating_point<Number> TextWriter& operator<<(
      Number value) {
    std::array<char, 32> digits;
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
    return *this << std::string_view(digits.data(), end);
  }

  void flush() {
    file_.write(std::as_bytes(std::span(buffer_)));
    buffer_.clear();
  }

 private:
  static constexpr std::size_t kBufferBytes = 1 << 20;

  const File& file_;
  std::string buffer_;
};

}  // namespace clearway
