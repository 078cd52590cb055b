#pragma once

#include <cstddef>
#include <cstdint>

namespace clearway {

/// Where a record of a point format has the point's class.
struct LasClassField {
  std::size_t byte;
  std::uint8_t mask;

  std::uint8_t of(const std::byte* record) const {
    return static_cast<std::uint8_t>(std::to_integer<std::uint8_t>(record[byte]) & mask);
  }
};

/// Formats 0 to 5 have three flags in the same byte.
constexpr LasClassField las_class_field(unsigned point_format) {
  return point_format < 6 ? LasClassField{15, 0x1F} : LasClassField{16, 0xFF};
}

}  // namespace clearway
