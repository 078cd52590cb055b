#include "io/formats/text/length_text.hpp"

#include <charconv>
#include <cmath>

#include "clearway/model.hpp"

namespace clearway {
namespace {

struct Unit {
  std::string_view name;
  double metres;
  int power;      ///< of ten, metres
  int ten_thous;  ///< of a metre, where it is no power of ten; otherwise 0
  bool of_files;  ///< files are written in it
};
constexpr Unit kUnits[] = {{"mm", kMetresPerMillimetre, -3, 0, true},
                           {"cm", kMetresPerCentimetre, -2, 0, true},
                           {"m", 1, 0, 0, true},
                           {"in", kMetresPerInch, 0, 254, true},
                           {"ft", kMetresPerFoot, 0, 3048, true},
                           {"km", 1000, 3, 0, false}};

std::optional<double> number_of(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// The decimal times a power of ten, rounded once: by its exponent.
std::optional<double> shifted(std::string_view digits, int power) {
  const std::size_t at = digits.find_first_of("eE");
  int exponent = 0;
  if (at != std::string_view::npos) {
    std::string_view given = digits.substr(at + 1);
    if (given.starts_with('+')) given.remove_prefix(1);
    const auto [end, error] = std::from_chars(given.data(), given.data() + given.size(), exponent);
    if (error != std::errc() || end != given.data() + given.size()) return std::nullopt;
    if (exponent > 400 || exponent < -400) return std::nullopt;
  }
  return number_of(std::string(digits.substr(0, at)) + "e" + std::to_string(exponent + power));
}

std::optional<double> length_in(std::string_view digits, const Unit& unit) {
  if (unit.ten_thous == 0) return shifted(digits, unit.power);
  const auto value = number_of(digits);
  if (!value) return std::nullopt;
  return static_cast<double>(static_cast<long double>(*value) * unit.ten_thous / 10'000);
}

/// "0.2ft" is the double nearest to 0.2.
double feet_in(std::string_view digits, const Unit& unit) {
  constexpr long double kFoot = 3048;
  const long double ten_thous =
      unit.ten_thous != 0 ? unit.ten_thous : std::pow(10.0L, 4 + unit.power);
  return static_cast<double>(number_of(digits).value_or(0) * ten_thous / kFoot);
}

std::optional<ParsedLength> parsed(std::string_view text) {
  const std::size_t last_digit = text.find_last_of("0123456789.");
  if (last_digit == std::string_view::npos) return std::nullopt;
  std::string_view unit = text.substr(last_digit + 1);
  std::string_view digits = text.substr(0, last_digit + 1);
  if (digits.starts_with('+') && !digits.starts_with("+-")) digits.remove_prefix(1);
  while (unit.starts_with(' ')) unit.remove_prefix(1);
  if (unit.empty()) {
    const auto value = number_of(digits);
    return value ? std::optional(ParsedLength{.value = *value}) : std::nullopt;
  }
  for (const Unit& known : kUnits) {
    if (unit != known.name) continue;
    const auto value = length_in(digits, known);
    if (!value) return std::nullopt;
    return ParsedLength{.value = *value, .has_unit = true, .feet = feet_in(digits, known)};
  }
  return std::nullopt;
}

}  // namespace

double ParsedLength::in_units_of(double metres) const {
  if (!has_unit) return value;
  return metres == kMetresPerFoot ? feet : value / metres;
}

std::optional<ParsedLength> length_of(std::string_view text) {
  const auto length = parsed(text);
  return length && std::isfinite(length->value) ? length : std::nullopt;
}

std::vector<std::string> file_unit_names() {
  std::vector<std::string> names;
  for (const Unit& unit : kUnits) {
    if (unit.of_files) names.emplace_back(unit.name);
  }
  return names;
}

std::optional<double> metres_of_file_unit(std::string_view name) {
  for (const Unit& unit : kUnits) {
    if (unit.of_files && unit.name == name) return unit.metres;
  }
  return std::nullopt;
}

}  // namespace clearway
