#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

/// Chunks of a checked dataset as stored in the file: their rows, followed by the checksum of
/// HDF5's fletcher32 filter. For threads that encode or check chunks besides the one that calls
/// HDF5.
namespace clearway::hdf5 {

inline constexpr std::size_t kChecksumBytes = 4;

/// Number of rows of a dataset's chunks: a power of two of at most 2^16, so that ranges of 2^16
/// rows end with a chunk whatever the columns are, or all rows where these are fewer.
std::uint64_t rows_of_chunk(std::uint64_t rows, std::uint64_t row_bytes);

/// Writes the checksum of a chunk's other bytes into its last four.
void seal_chunk(std::span<std::byte> chunk);

/// Whether a chunk's last four bytes are the checksum of the others.
bool is_sealed(std::span<const std::byte> chunk);

}  // namespace clearway::hdf5
