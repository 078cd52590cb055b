#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>

/// Extra bytes of LAS records: values that every record has behind those of its point format.
/// Source: LAS 1.4 R15 (ASPRS), "Extra Bytes VLR".
namespace clearway {

/// Type codes of the specification.
enum class LasExtraType : std::uint8_t { kUndocumented = 0, kUint32 = 5, kDouble = 10 };

constexpr std::uint16_t kLasExtraBytes = 192;  ///< size of a field's description
using LasExtraDescription = std::array<std::byte, kLasExtraBytes>;

/// Describes a field of extra bytes. bytes: size of an undocumented one.
inline LasExtraDescription las_extra_bytes(std::string_view name, LasExtraType type,
                                           std::string_view description, std::uint8_t bytes = 0) {
  constexpr std::size_t kType = 2, kOptions = 3, kName = 4, kText = 160, kTextBytes = 32;
  LasExtraDescription out{};
  out[kType] = static_cast<std::byte>(type);
  out[kOptions] = static_cast<std::byte>(bytes);
  std::memcpy(&out[kName], name.data(), std::min(name.size(), kTextBytes));
  std::memcpy(&out[kText], description.data(), std::min(description.size(), kTextBytes));
  return out;
}

/// Describes a field of type double in which the value `none` means that a point has no value.
inline LasExtraDescription las_extra_bytes(std::string_view name, std::string_view description,
                                           double none) {
  constexpr std::size_t kOptions = 3, kNone = 40;
  LasExtraDescription out = las_extra_bytes(name, LasExtraType::kDouble, description);
  out[kOptions] = std::byte{1};
  std::memcpy(&out[kNone], &none, sizeof none);
  return out;
}

}  // namespace clearway
