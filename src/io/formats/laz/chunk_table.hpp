#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "io/formats/laz/chunk_decoder.hpp"

namespace clearway::laz {

/// Where the points of a file lie, and how many there are, by its header.
struct PointBytes {
  std::uint64_t begin = 0;  ///< the 8 bytes that say where the chunk table is, or the first chunk
  std::uint64_t end = 0;    ///< the extended variable length records, or the end of the file
  std::uint64_t points = 0;
};

/// All chunks of a file with chunks, from its chunk table. None where no table was written, as by a
/// writer that was interrupted: then chunks follow each other from the byte at begin + 8. Memory is
/// bounded by the bytes that are there. Throws InputError where the table does not agree with the
/// header or the bytes.
std::optional<std::vector<Chunk>> read_chunk_table(const InputBuffer& input, const Scheme& scheme,
                                                   const PointBytes& bytes);

}  // namespace clearway::laz
