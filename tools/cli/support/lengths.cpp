#include "cli/support/lengths.hpp"

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

namespace clearway::tool {
namespace {

struct Unit {
  std::string_view name;
  int power;      ///< of ten, metres
  int ten_thous;  ///< of a metre, where it is no power of ten; otherwise 0
};
constexpr Unit kUnits[] = {{"m", 0, 0},  {"mm", -3, 0},  {"cm", -2, 0},
                           {"km", 3, 0}, {"in", 0, 254}, {"ft", 0, 3048}};

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

std::optional<ParsedLength> parse(std::string_view text) {
  const std::size_t last_digit = text.find_last_of("0123456789.");
  if (last_digit == std::string_view::npos) return std::nullopt;
  std::string_view unit = text.substr(last_digit + 1);
  const std::string_view digits = text.substr(0, last_digit + 1);
  while (unit.starts_with(' ')) unit.remove_prefix(1);
  if (unit.empty()) {
    const auto value = number_of(digits);
    return value ? std::optional(ParsedLength{*value, false}) : std::nullopt;
  }
  for (const Unit& known : kUnits) {
    if (unit != known.name) continue;
    const auto value = length_in(digits, known);
    return value ? std::optional(ParsedLength{*value, true}) : std::nullopt;
  }
  return std::nullopt;
}

}  // namespace

ParsedLength parse_length(const std::string& option, const std::string& text, LengthRange range) {
  const auto length = parse(text);
  if (length && std::isfinite(length->value)) {
    const double value = length->value;
    if (range == LengthRange::kAny || value > 0) return *length;
    if (range == LengthRange::kFromZero && value == 0) return *length;
  }
  const char* limit = range == LengthRange::kAboveZero  ? " above 0"
                      : range == LengthRange::kFromZero ? ", 0 or more"
                                                        : "";
  throw CLI::ValidationError(option,
                             text + ": expected a finite number of metres" + limit +
                                 ", for example 0.1, or a number with mm, cm, m, km, in or ft, "
                                 "for example 10cm");
}

CLI::Option* LengthOptions::add(CLI::App& command, const std::string& name, double& length,
                                const std::string& description, LengthRange range) {
  return command
      .add_option_function<std::string>(
          name,
          [this, &length, name, range](const std::string& text) {
            const ParsedLength parsed = parse_length(name, text, range);
            length = parsed.value;
            if (parsed.has_unit) in_metres_.push_back(&length);
          },
          description)
      ->type_name("METRES");
}

CLI::Option* LengthOptions::add(CLI::App& command, const std::string& name,
                                std::optional<double>& length, const std::string& description,
                                LengthRange range) {
  return command
      .add_option_function<std::string>(
          name,
          [this, &length, name, range](const std::string& text) {
            const ParsedLength parsed = parse_length(name, text, range);
            length = parsed.value;
            if (parsed.has_unit) optional_in_metres_.push_back(&length);
          },
          description)
      ->type_name("METRES");
}

void LengthOptions::convert(double metres) const {
  for (double* length : in_metres_) *length /= metres;
  for (std::optional<double>* length : optional_in_metres_) **length /= metres;
}

}  // namespace clearway::tool
