#include "io/formats/las/geotiff_keys.hpp"

#include <algorithm>
#include <cstdint>

#include "io/formats/byte_load.hpp"

namespace clearway {
namespace {

constexpr std::uint16_t kModelType = 1024;  // 1 projected, 2 geographic, 3 geocentric
constexpr std::uint16_t kGeodeticSystem = 2048;
constexpr std::uint16_t kGeodeticLinearUnit = 2052;
constexpr std::uint16_t kProjectedSystem = 3072;
constexpr std::uint16_t kProjectedLinearUnit = 3076;

/// The value of a key that holds one short; 0 where it is missing.
std::uint16_t value_of(std::span<const std::byte> directory, std::uint16_t wanted) {
  if (directory.size() < 8) return 0;
  const std::size_t declared = load<std::uint16_t>(directory.data() + 6);
  const std::size_t keys = std::min(declared, directory.size() / 8 - 1);
  for (std::size_t i = 1; i <= keys; ++i) {
    const std::byte* entry = directory.data() + 8 * i;
    const bool is_short = load<std::uint16_t>(entry + 2) == 0;
    if (is_short && load<std::uint16_t>(entry) == wanted) return load<std::uint16_t>(entry + 6);
  }
  return 0;
}

LengthUnit unit_of(std::uint16_t code) {
  switch (code) {
    case 9001:
      return LengthUnit::kMetre;
    case 9002:
      return LengthUnit::kFoot;
    case 9003:
      return LengthUnit::kUsSurveyFoot;
    default:
      return LengthUnit::kUnknown;
  }
}

}  // namespace

LengthUnit horizontal_unit(std::span<const std::byte> key_directory) {
  const std::uint16_t model = value_of(key_directory, kModelType);
  const std::uint16_t projected_unit = value_of(key_directory, kProjectedLinearUnit);
  if (model == 2) return LengthUnit::kDegree;
  if (model == 3) return unit_of(value_of(key_directory, kGeodeticLinearUnit));
  if (model == 0 && projected_unit == 0 && value_of(key_directory, kProjectedSystem) == 0 &&
      value_of(key_directory, kGeodeticSystem) != 0) {
    return LengthUnit::kDegree;
  }
  return unit_of(projected_unit);
}

}  // namespace clearway
