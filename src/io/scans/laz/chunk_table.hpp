#pragma once

#include <cstdint>
#include <optional>
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

}  // namespace clearway::laz
