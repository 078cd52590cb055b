#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstring>

namespace clearway {

static_assert(std::endian::native == std::endian::little, "file formats are read by memcpy");

/// Loads a little-endian number from any address, aligned or not.
template <typename Number>
Number load(const std::byte* bytes) {
  Number value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

/// Loads a big-endian number from any address, aligned or not.
template <typename Number>
Number load_swapped(const std::byte* bytes) {
  std::array<std::byte, sizeof(Number)> turned;
  for (std::size_t i = 0; i < turned.size(); ++i) turned[i] = bytes[turned.size() - 1 - i];
  return std::bit_cast<Number>(turned);
}

}  // namespace clearway
