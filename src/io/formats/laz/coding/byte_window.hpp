#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "io/formats/input_buffer.hpp"

namespace clearway::laz {

/// Thrown where a chunk cannot be what an encoder wrote. The reader of the file adds its name, the
/// chunk and what to do.
struct DamagedChunk {
  std::string what;
};

/// A run of bytes of a file, loaded piece by piece, for a decoder that checks no bounds: behind the
/// last byte of the run there are as many zeros as it may read before it asks again.
class ByteWindow {
 public:
  /// The bytes [begin, end) of the input, which must outlive its use. `most`: bytes read at most
  /// between two calls of ahead(). Returns the first byte. Throws DamagedChunk where begin > end.
  const std::byte* open(const InputBuffer& input, std::uint64_t begin, std::uint64_t end,
                        std::ptrdiff_t most);

  /// The place of the byte at `cursor`, with `most` bytes to be read from there. Throws
  /// DamagedChunk where the cursor is behind the run's end.
  const std::byte* ahead(const std::byte* cursor) {
    if (loaded_ - cursor >= most_) return cursor;
    return refill(cursor);
  }
  /// The next `count` bytes. Throws DamagedChunk where the run ends before them.
  std::span<const std::byte> take(const std::byte*& cursor, std::size_t count);

  /// Of the byte at `cursor` in the file.
  std::uint64_t position(const std::byte* cursor) const {
    return next_ - static_cast<std::uint64_t>(loaded_ - cursor);
  }

 private:
  static constexpr std::size_t kPiece = std::size_t{1} << 16;

  const std::byte* refill(const std::byte* cursor);
  void load(std::size_t kept);

  const InputBuffer* input_ = nullptr;
  std::uint64_t next_ = 0;  ///< position of the byte behind the loaded ones
  std::uint64_t end_ = 0;
  std::ptrdiff_t most_ = 0;
  std::vector<std::byte> buffer_;
  const std::byte* loaded_ = nullptr;  ///< behind the last byte loaded
};

}  // namespace clearway::laz
