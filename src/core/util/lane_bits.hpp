#pragma once

#include <bit>
#include <cstdint>
#include <cstring>

namespace clearway {

/// Packs 64 bytes, each 0 or 1, into bits.
inline std::uint64_t packed_bits(const std::uint8_t (&flags)[64]) {
  std::uint64_t bits = 0;
  for (int i = 0; i < 8; ++i) {
    std::uint64_t eight;
    std::memcpy(&eight, flags + 8 * i, 8);
    // Byte k of the word becomes bit k of the product's last byte.
    bits |= (eight * 0x0102040810204080U >> 56) << (8 * i);
  }
  return bits;
}

/// Calls visit(number) for each bit that is set, the lowest first.
template <typename Visit>
void for_each_bit(std::uint64_t bits, const Visit& visit) {
  for (; bits != 0; bits &= bits - 1) visit(static_cast<std::uint32_t>(std::countr_zero(bits)));
}

}  // namespace clearway
