#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "io/formats/laz/chunk_decoder.hpp"

namespace clearway::laz {

/// Decodes consecutive chunks at the same time, on the threads of the caller's oneTBB arena.
class ChunkGroups {
 public:
  explicit ChunkGroups(const Scheme& scheme);

  /// Whether a chunk has few enough points to be decoded in groups, and so to be kept in memory as
  /// a whole.
  bool takes(const Chunk& chunk) const;
  /// Decodes the first ones of `chunks`, all of which takes() accepts: as many as memory and
  /// threads suggest, at least one. Returns their number; points() and classes() are then theirs.
  /// first: index of the first chunk in the file, and count: number of all chunks, for messages.
  /// Throws InputError for the first chunk that is damaged.
  std::size_t decode(const InputBuffer& input, std::span<const Chunk> chunks, std::size_t first,
                     std::size_t count);
  /// Decodes one chunk that takes() accepts. Several threads may call it at once. Throws
  /// DamagedChunk.
  void decode_alone(const InputBuffer& input, const Chunk& chunk, PointRoom points);
  std::span<const Quanta> points() const { return points_; }
  std::span<const std::uint8_t> classes() const { return classes_; }  ///< classes of points()

 private:
  bool one_at_a_time_;
  std::vector<Quanta> points_;
  std::vector<std::uint8_t> classes_;
  tbb::enumerable_thread_specific<std::unique_ptr<ChunkDecoder>> decoders_;
};

/// Throws InputError "name: chunk 12 of 80: what; expected...". index: the chunk's, from 0. count:
/// number of chunks; 0 where it is not known.
[[noreturn]] void refuse_chunk(const std::string& name, std::uint64_t index, std::uint64_t count,
                               const DamagedChunk& damage);

}  // namespace clearway::laz
