#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "io/formats/input_buffer.hpp"
#include "io/formats/laz/coding/byte_window.hpp"
#include "io/formats/laz/laz_scheme.hpp"

namespace clearway::laz {

using Quanta = std::array<std::int32_t, 3>;

/// Room for points and, in the same order, their classes; each has `count`.
struct PointRoom {
  Quanta* quanta = nullptr;
  std::uint8_t* classes = nullptr;
  std::size_t count = 0;

  PointRoom first(std::size_t points) const { return {quanta, classes, points}; }
  PointRoom behind(std::size_t points) const {
    return {quanta + points, classes + points, count - points};
  }
};

/// Some points, compressed on their own.
struct Chunk {
  std::uint64_t begin = 0;  ///< position in the file
  std::uint64_t end = 0;    ///< where it ends, or must not go beyond where ends_there is false
  std::uint64_t points = 0;
  bool ends_there = true;
};

/// Decodes chunks, one after the other, each in pieces of any size. Memory does not depend on what
/// a chunk says of itself. All throw DamagedChunk.
class ChunkDecoder {
 public:
  virtual ~ChunkDecoder() = default;
  /// Before the first point of a chunk of one point or more. The input must outlive its use.
  virtual void begin(const InputBuffer& input, const Chunk& chunk) = 0;
  /// The next points of the chunk; no more than it has left.
  virtual void decode(PointRoom points) = 0;
  /// Behind its last point: whether the chunk ends where it should. Returns where it ends.
  virtual std::uint64_t finish() = 0;
};

/// A decoder for the items and the kind of chunks of a file.
std::unique_ptr<ChunkDecoder> make_chunk_decoder(const Scheme& scheme);
std::unique_ptr<ChunkDecoder> make_pointwise_decoder(const Scheme& scheme);
std::unique_ptr<ChunkDecoder> make_layered_decoder(const Scheme& scheme);

/// What to say where a run of bytes is not used up.
DamagedChunk unused_bytes(std::uint64_t bytes);

}  // namespace clearway::laz
