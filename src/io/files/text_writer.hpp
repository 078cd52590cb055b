#pragma once

#include <array>
#include <charconv>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "io/files/file.hpp"

namespace clearway {

/// Text in memory. A double is written with the fewest digits that give it back exactly.
class TextBuffer {
 public:
  TextBuffer& operator<<(std::string_view text) {
    text_ += text;
    return *this;
  }

  template <typename Number>
  requires std::integral<Number> || std::floating_point<Number> TextBuffer& operator<<(
      Number value) {
    std::array<char, 32> digits;
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
    return *this << std::string_view(digits.data(), end);
  }

  const std::string& text() const { return text_; }
  void clear() { text_.clear(); }
  void reserve(std::size_t bytes) { text_.reserve(bytes); }

 private:
  std::string text_;
};

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

/// A text, such as a body's name, as a cell of a CSV file (RFC 4180): in quotes where it holds a
/// comma, a quote or a line break. A text that a spreadsheet would run as a formula, because it
/// begins with "=", "+", "-", "@", a tab or a line break, gets an apostrophe in front, which
/// spreadsheets take as "this is text". A text that is a number, such as "-12.5", stays as it is.
std::string csv_cell(std::string_view text);

/// A length of a table that people read, to 0.1 mm: the digits after that are no more than
/// roundings, and JSON and HDF5 keep them. up: rounds up what is more than a roundoff above.
inline double readable_length(double length, bool up = false) {
  constexpr double kTenthsOfMillimetres = 1e4, kRoundoff = 1e-6;
  const double tenths = length * kTenthsOfMillimetres;
  const double whole = up ? std::ceil(tenths - kRoundoff) : std::round(tenths);
  return whole / kTenthsOfMillimetres + 0.0;  // 0 instead of -0
}

/// A label of a pose as a cell of a CSV file.
inline double label_cell(double number) { return number; }
inline std::string label_cell(const std::string& text) { return csv_cell(text); }

}  // namespace clearway
