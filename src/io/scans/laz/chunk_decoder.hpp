#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "io/scans/input_buffer.hpp"
#include "io/scans/laz/coding/byte_window.hpp"
#include "io/scans/laz/laz_scheme.hpp"

namespace clearway::laz {

using Quanta = std::array<std::int32_t, 3>;

/// Room for `count` points and, in the same order, their classes, flags (bits of PointFlags) and
/// GPS times. flags, times: null unless the scheme asks for them.
struct PointRoom {
  Quanta* quanta = nullptr;
  std::uint8_t* classes = nullptr;
  std::uint8_t* flags = nullptr;
  double* times = nullptr;
  std::size_t count = 0;

  PointRoom first(std::size_t points) const { return {quanta, classes, flags, times, points}; }
  PointRoom behind(std::size_t points) const {
    return {quanta + points, classes + points, flags ? flags + points : nullptr,
            times ? times + points : nullptr, count - points};
  }
};

/// A chunk: points that are compressed independently of others.
struct Chunk {
  std::uint64_t begin = 0;  ///< position in the file
  /// Position after the chunk, or where ends_there is false an upper bound on it.
  std::uint64_t end = 0;
  std::uint64_t points = 0;
  bool ends_there = true;
};

/// Decodes chunks one after the other, each in pieces of any size. Memory does not depend on what a
/// chunk declares. All functions throw DamagedChunk.
class ChunkDecoder {
 public:
  virtual ~ChunkDecoder() = default;
  /// Begins a chunk of one point or more. The input must outlive its use.
  virtual void begin(const InputBuffer& input, const Chunk& chunk) = 0;
  /// Decodes the next points of the chunk, of which there must be as many.
  void decode(PointRoom points);
  /// Called after the chunk's last point. Returns the position where the chunk ends; throws where
  /// that is wrong.
  virtual std::uint64_t finish() = 0;

 protected:
  /// Decodes points after the first. Returns false for bits that no encoder writes.
  virtual bool decode_others(PointRoom points) = 0;
  /// Takes the first point from its record, which is not compressed. point_format: one of those
  /// that the decoder reads and that have GPS times, where these are wanted.
  void take_first(const std::byte* record, unsigned point_format);

  // Those of the first point.
  Quanta quanta_{};
  std::uint8_t class_ = 0, flags_ = 0;
  double time_ = 0;

 private:
  bool is_first_ = false;
};

/// Makes a decoder for the items and the kind of chunks of a file.
std::unique_ptr<ChunkDecoder> make_chunk_decoder(const Scheme& scheme);
std::unique_ptr<ChunkDecoder> make_pointwise_decoder(const Scheme& scheme);
std::unique_ptr<ChunkDecoder> make_layered_decoder(const Scheme& scheme);

/// The error for a run of bytes that is not used up.
DamagedChunk unused_bytes(std::uint64_t bytes);

}  // namespace clearway::laz
