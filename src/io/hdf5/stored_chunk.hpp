#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

/// Chunks of a checked dataset as the file has them: their rows, then the checksum of HDF5's
/// fletcher32 filter. For threads that encode or check chunks beside the one that calls HDF5.
namespace clearway::hdf5 {

inline constexpr std::size_t kChecksumBytes = 4;

/// Rows of each chunk of a dataset: a power of two, so that ranges of 2^16 rows end at the ends of
/// chunks whatever the columns, or all rows where they are fewer.
std::uint64_t rows_of_chunk(std::uint64_t rows, std::uint64_t row_bytes);

/// What HDF5's fletcher32 filter gives for an even number of bytes.
std::uint32_t fletcher32(std::span<const std::byte> bytes);

/// Writes the checksum of the bytes before it into a chunk's last four.
void seal_chunk(std::span<std::byte> chunk);

/// Whether a chunk's last four bytes are the checksum of those before.
bool is_sealed(std::span<const std::byte> chunk);

}  // namespace clearway::hdf5
