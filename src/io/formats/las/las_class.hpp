#pragma once

#include <cstddef>
#include <cstdint>

namespace clearway {

/// The position of the class in the records of a point format.
struct LasClassField {
  std::size_t byte;
  std::uint8_t mask;

  std::uint8_t of(const std::byte* record) const {
    return static_cast<std::uint8_t>(std::to_integer<std::uint8_t>(record[byte]) & mask);
  }
};

/// The position of the class in a point format. In formats 0 to 5 its byte also holds three flags.
constexpr LasClassField las_class_field(unsigned point_format) {
  return point_format < 6 ? LasClassField{15, 0x1F} : LasClassField{16, 0xFF};
}

}  // namespace clearway
