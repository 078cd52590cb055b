#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace clearway {

/// CRC-32C (Castagnoli) of the bytes: polynomial 0x1EDC6F41, bits reflected, start and end
/// inverted. Uses the processor's instruction where there is one. Source: RFC 3720, section 12.1
/// and appendix B.4.
std::uint32_t crc32c(std::span<const std::byte> bytes);

/// CRC-32C computed by tables, on any processor.
std::uint32_t crc32c_by_table(std::span<const std::byte> bytes);

}  // namespace clearway
