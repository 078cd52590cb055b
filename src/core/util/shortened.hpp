#pragma once

#include <cstddef>
#include <string>

namespace clearway {

/// The text, or where it is longer than `most_bytes` as much of it, never cut within a character,
/// and "...".
inline std::string shortened(const std::string& text, std::size_t most_bytes) {
  if (text.size() <= most_bytes) return text;
  std::size_t end = most_bytes;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0) == 0x80) --end;
  return text.substr(0, end) + " ...";
}

}  // namespace clearway
