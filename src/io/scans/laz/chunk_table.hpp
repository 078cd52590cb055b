#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/scans/laz/chunk_decoder.hpp"

namespace clearway::laz {

/// Position and number of a file's points according to its header.
struct PointBytes {
  /// The 8 bytes with the position of the chunk table, or the first chunk.
  std::uint64_t begin = 0;
  std::uint64_t end = 0;  ///< start of the extended variable length records, or the end of the file
  std::uint64_t points = 0;
};

/// All chunks of a file according to its chunk table. Nullopt where none was written, as by a
/// writer that was interrupted; chunks then follow each other from the byte begin + 8. Memory is
/// bounded by the bytes that exist. Throws InputError where the table does not agree with the
/// header or the bytes.
std::optional<std::vector<Chunk>> read_chunk_table(const InputBuffer& input, const Scheme& scheme,
                                                   const PointBytes& bytes);

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
  /// Flags of points(); empty unless the scheme asks for them.
  std::span<const std::uint8_t> flags() const { return flags_; }
  /// GPS times of points(); empty unless the scheme asks for them.
  std::span<const double> times() const { return times_; }

 private:
  bool one_at_a_time_;
  bool with_flags_, with_times_;
  std::vector<Quanta> points_;
  std::vector<std::uint8_t> classes_;
  std::vector<std::uint8_t> flags_;
  std::vector<double> times_;
  tbb::enumerable_thread_specific<std::unique_ptr<ChunkDecoder>> decoders_;
};

/// Throws InputError "name: chunk 12 of 80: what; expected...". index: the chunk's, from 0. count:
/// number of chunks; 0 where it is not known.
[[noreturn]] void refuse_chunk(const std::string& name, std::uint64_t index, std::uint64_t count,
                               const DamagedChunk& damage);

}  // namespace clearway::laz
