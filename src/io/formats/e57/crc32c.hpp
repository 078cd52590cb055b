#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace clearway {

/// CRC-32C (Castagnoli) of the bytes: polynomial 0x1EDC6F41, bits reflected, start and end
/// inverted. By the processor's instruction where it has one. Source: RFC 3720, section 12.1 and
/// appendix B.4.
std::uint32_t crc32c(std::span<const std::byte> bytes);

/// The same on any processor.
std::uint32_t crc32c_by_table(std::span<const std::byte> bytes);

}  // namespace clearway
