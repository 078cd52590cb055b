#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace clearway {

/// The checksum of HDF5's fletcher32 filter. For threads that seal chunks besides the one that
/// calls HDF5.
std::uint32_t fletcher32(std::span<const std::byte> bytes);

/// Puts the checksum of a chunk's values behind them, into the last four bytes of the chunk, as the
/// filter does.
void seal_fletcher32(std::span<std::byte> chunk);

}  // namespace clearway
