#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "io/scans/input_buffer.hpp"

namespace clearway::laz {

/// Thrown where a chunk cannot come from an encoder. The reader of the file adds the file's name,
/// the chunk and advice.
struct DamagedChunk {
  std::string what;
};

/// A run of bytes of a file, loaded piece by piece for a decoder that checks no bounds. Behind the
/// last byte of the run there are as many zeros as the decoder may read before it calls ahead()
/// again.
class ByteWindow {
 public:
  /// Opens the bytes [begin, end) of the input, which must outlive its use. most: greatest number
  /// of bytes read between two calls of ahead(). Returns the first byte. Throws DamagedChunk where
  /// begin > end.
  const std::byte* open(const InputBuffer& input, std::uint64_t begin, std::uint64_t end,
                        std::ptrdiff_t most);

  /// The address of the byte at `cursor`, from which `most` bytes may be read. Throws DamagedChunk
  /// where the cursor is after the end of the run.
  const std::byte* ahead(const std::byte* cursor) {
    if (loaded_ - cursor >= most_) return cursor;
    return refill(cursor);
  }
  /// Takes the next `count` bytes. Throws DamagedChunk where the run ends before them.
  std::span<const std::byte> take(const std::byte*& cursor, std::size_t count);

  /// Position in the file of the byte at `cursor`.
  std::uint64_t position(const std::byte* cursor) const {
    return next_ - static_cast<std::uint64_t>(loaded_ - cursor);
  }

 private:
  static constexpr std::size_t kPiece = std::size_t{1} << 16;

  const std::byte* refill(const std::byte* cursor);
  void load(std::size_t kept);

  const InputBuffer* input_ = nullptr;
  std::uint64_t next_ = 0;  ///< position of the byte after the loaded ones
  std::uint64_t end_ = 0;
  std::ptrdiff_t most_ = 0;
  std::vector<std::byte> buffer_;
  const std::byte* loaded_ = nullptr;  ///< address after the last byte loaded
};

}  // namespace clearway::laz
