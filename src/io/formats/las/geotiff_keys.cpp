#include "io/formats/las/geotiff_keys.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>

#include "io/formats/byte_load.hpp"
#include "io/formats/proj_objects.hpp"

namespace clearway {
namespace {

void keep_quiet(void*, int, const char*) {}

/// The unit, in metres, of a projected coordinate reference system with this EPSG code; nullopt
/// where PROJ's database is not installed or lacks the code.
std::optional<double> unit_of_epsg(std::uint16_t code) {
  const ProjContext context = start_proj(keep_quiet, nullptr);
  if (!context) return std::nullopt;
  const ProjObject crs(proj_create_from_database(
      context.get(), "EPSG", std::to_string(code).c_str(), PJ_CATEGORY_CRS, 0, nullptr));
  if (!crs) return std::nullopt;
  const double metres = unit_of_axis(context.get(), crs.get(), 0);
  return metres != 0 ? std::optional(metres) : std::nullopt;
}

// Key of the model's type: 1 projected, 2 geographic, 3 geocentric.
constexpr std::uint16_t kModelType = 1024;
constexpr std::uint16_t kGeodeticSystem = 2048;
constexpr std::uint16_t kGeodeticLinearUnit = 2052;
constexpr std::uint16_t kProjectedSystem = 3072;
constexpr std::uint16_t kProjectedLinearUnit = 3076;
constexpr std::uint16_t kVerticalUnit = 4099;
constexpr std::uint16_t kUserDefined = 32767;
constexpr std::uint16_t kFirstUnit = 9000, kLastUnit = 9099;  // EPSG codes of units of length

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

/// The unit of a GeoTIFF key; code 0 names none.
StatedUnit unit_of(std::uint16_t code) {
  switch (code) {
    case 0:
      return {};
    case 9001:
      return {LengthUnit::kMetre, {}};
    case 9002:
      return {LengthUnit::kFoot, {}};
    case 9003:
      return {LengthUnit::kUsSurveyFoot, {}};
    default:
      break;
  }
  // Some files have the code of a projection here.
  const bool is_unit = code >= kFirstUnit && code <= kLastUnit;
  return {LengthUnit::kUnknown, is_unit ? "the GeoTIFF unit " + std::to_string(code) : ""};
}

/// How the code of the projection contradicts the unit that a key names; empty where it does not.
std::string doubt_of(std::span<const std::byte> keys) {
  const std::uint16_t code = value_of(keys, kProjectedSystem);
  const StatedUnit named = unit_of(value_of(keys, kProjectedLinearUnit));
  if (code == 0 || code == kUserDefined || value_of(keys, kModelType) == 2) return {};
  if (named.unit == LengthUnit::kUnknown) return {};
  const auto metres = unit_of_epsg(code);
  if (!metres || unit_of_length(*metres).unit == named.unit) return {};
  return "its GeoTIFF keys contradict each other: they name the unit " + to_string(named.unit) +
         ", and EPSG:" + std::to_string(code) + ", whose unit is " + units_text(*metres) +
         ". It is taken to be in the named unit";
}

StatedUnit plane_unit(std::span<const std::byte> keys) {
  const std::uint16_t model = value_of(keys, kModelType);
  const std::uint16_t unit = value_of(keys, kProjectedLinearUnit);
  const std::uint16_t projection = value_of(keys, kProjectedSystem);
  if (model == 2) return {LengthUnit::kDegrees, {}};
  if (model == 3) return unit_of(value_of(keys, kGeodeticLinearUnit));
  if (model == 0 && unit == 0 && projection == 0 && value_of(keys, kGeodeticSystem) != 0) {
    return {LengthUnit::kDegrees, {}};
  }
  const bool has_unit = unit >= kFirstUnit && unit <= kLastUnit;
  if (!has_unit && projection != 0 && projection != kUserDefined) {
    if (const auto metres = unit_of_epsg(projection)) return unit_of_length(*metres);
  }
  return unit_of(unit);
}

}  // namespace

CrsUnits units_of_geotiff(std::span<const std::byte> key_directory) {
  CrsUnits units =
      crs_units(plane_unit(key_directory), unit_of(value_of(key_directory, kVerticalUnit)));
  if (units.doubt.empty()) units.doubt = doubt_of(key_directory);
  return units;
}

std::uint16_t epsg_of_geotiff(std::span<const std::byte> key_directory) {
  const bool geographic = value_of(key_directory, kModelType) >= 2;
  const std::uint16_t projected = value_of(key_directory, kProjectedSystem);
  const std::uint16_t code =
      projected == 0 || geographic ? value_of(key_directory, kGeodeticSystem) : projected;
  return code == kUserDefined ? 0 : code;
}

}  // namespace clearway
