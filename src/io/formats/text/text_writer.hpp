#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "io/formats/text/text_buffer.hpp"
#include "io/system/file.hpp"

namespace clearway {

/// Appends text through a TextBuffer to a file. The caller owns the file; what is not flushed is
/// lost. Throws ResourceError as File does.
class TextWriter {
 public:
  explicit TextWriter(const File& file) : file_(file) { buffer_.reserve(kBufferBytes); }

  template <typename Value>
  TextWriter& operator<<(const Value& value) {
    if (buffer_.text().size() > kBufferBytes) flush();
    buffer_ << value;
    return *this;
  }

  void flush() {
    file_.write(std::as_bytes(std::span(buffer_.text())));
    buffer_.clear();
  }

 private:
  static constexpr std::size_t kBufferBytes = 1 << 20;

  const File& file_;
  TextBuffer buffer_;
};

}  // namespace clearway
