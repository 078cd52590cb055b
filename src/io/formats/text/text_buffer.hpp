#pragma once

#include <array>
#include <charconv>
#include <concepts>
#include <string>
#include <string_view>

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

}  // namespace clearway
