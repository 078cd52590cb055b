#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace clearway {

/// The checksum of HDF5's fletcher32 filter. For threads that seal chunks besides the one that
/// calls HDF5.
std::uint32_t fletcher32(std::span<const std::byte> bytes);

}  // namespace clearway
