#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace clearway {

// The lines of a text end with LF, CR LF or CR alone, which may be mixed.

inline bool is_line_end(char c) { return c == '\n' || c == '\r'; }

/// The first LF or CR of a text, or its end. Goes eight bytes at a time, since every byte of every
/// text passes here. Source: Mycroft, zero byte in a word.
inline const char* find_line_end(const char* at, const char* end) {
  constexpr std::uint64_t kOnes = 0x0101010101010101;
  const auto zeros = [](std::uint64_t word) { return (word - kOnes) & ~word & (kOnes << 7); };
  for (; end - at >= 8; at += 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, at, sizeof word);
    const std::uint64_t found = zeros(word ^ (kOnes * '\n')) | zeros(word ^ (kOnes * '\r'));
    if (found != 0) return at + std::countr_zero(found) / 8;
  }
  while (at != end && !is_line_end(*at)) ++at;
  return at;
}

/// Length in bytes of the line break at `at`: 2 for CR LF, and 0 at the end of the text.
inline std::size_t line_break_bytes(const char* at, const char* end) {
  if (at == end) return 0;
  return *at == '\r' && end - at > 1 && at[1] == '\n' ? 2 : 1;
}

/// Removes the first line from a text, and returns it without its line break.
inline std::string_view take_line(std::string_view& text) {
  const char* const end = text.data() + text.size();
  const char* const stop = find_line_end(text.data(), end);
  const std::string_view line = text.substr(0, static_cast<std::size_t>(stop - text.data()));
  text.remove_prefix(line.size() + line_break_bytes(stop, end));
  return line;
}

inline std::size_t count_line_breaks(std::string_view text) {
  auto breaks = static_cast<std::size_t>(std::ranges::count(text, '\n'));
  for (std::size_t cr = text.find('\r'); cr != text.npos; cr = text.find('\r', cr + 1)) {
    if (!text.substr(cr + 1).starts_with('\n')) ++breaks;
  }
  return breaks;
}

}  // namespace clearway
