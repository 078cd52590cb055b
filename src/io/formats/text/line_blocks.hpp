#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <vector>

#include "io/formats/input_buffer.hpp"

namespace clearway {

/// Divides the rest of a text into blocks of lines that can be read at the same time. A line
/// belongs to the block in which it begins.
class LineBlocks {
 public:
  static constexpr std::size_t kBlockBytes = std::size_t{1} << 18;  ///< fits in L2

  /// input: can seek, stands at the start of a line, and outlives this object.
  explicit LineBlocks(const InputBuffer& input);

  std::size_t count() const { return (end_ - begin_ + kBlockBytes - 1) / kBlockBytes; }

  /// The lines of a block; the last may lack its line break. `room` holds the text. May be called
  /// from several threads at once. A line that is too long is cut, but remains longer than allowed.
  std::string_view read(std::size_t block, std::vector<char>& room) const;

 private:
  const InputBuffer& input_;
  std::uint64_t begin_, end_;  ///< range of bytes in the file
};

/// Calls use(line) for the lines of a block, in the form of InputBuffer::next_line(), until it
/// returns false. Returns false in that case and for a line that is too long.
template <typename Use>
bool each_line(std::string_view block, Use use) {
  while (!block.empty()) {
    const auto* const found =
        static_cast<const char*>(std::memchr(block.data(), '\n', block.size()));
    const std::size_t length =
        found ? static_cast<std::size_t>(found - block.data()) : block.size();
    if (length > InputBuffer::kLongestLine) return false;
    std::string_view line = block.substr(0, length);
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (!use(line)) return false;
    block.remove_prefix(length + (found ? 1 : 0));
  }
  return true;
}

}  // namespace clearway
