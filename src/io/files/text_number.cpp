#include "io/files/text_number.hpp"

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <string>

#include "io/scans/length_unit.hpp"

namespace clearway {

bool parse_extreme_number(const char* begin, const char* end, double& value) {
  value = std::strtod(std::string(begin, end).c_str(), nullptr);
  return std::isfinite(value);
}

bool parse_quoted_number(const char*& at, const char* end, double& value) {
  const char* within = skip_blanks(at + 1, end);
  if (within == end || *within == '"' || !parse_number(within, end, value)) return false;
  within = skip_blanks(within, end);
  if (within == end || *within != '"') return false;
  at = within + 1;
  return true;
}

std::optional<std::size_t> parse_number_line(std::string_view line, std::span<double> out) {
  const char* end = line.data() + line.size();
  const char* at = skip_blanks(line.data(), end);
  char kind = 0;
  std::size_t count = 0;
  while (at != end) {
    double value = 0;
    if (!parse_number(at, end, value)) return std::nullopt;
    if (count < out.size()) out[count] = value;
    ++count;
    const char separator = skip_separator(at, end);
    if (at == end) {
      if (separator == ',' || separator == ';') return std::nullopt;
      break;
    }
    if (separator == 0 || (kind != 0 && separator != kind)) return std::nullopt;
    kind = separator;
  }
  return count > out.size() ? out.size() + 1 : count;
}

std::optional<double> parse_whole_number(std::string_view field) {
  const char* end = field.data() + field.size();
  const char* at = skip_blanks(field.data(), end);
  double value = 0;
  if (!parse_number(at, end, value) || skip_blanks(at, end) != end) return std::nullopt;
  return value;
}

namespace {

std::optional<double> number_of(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// The decimal times a power of ten, computed by changing its exponent so that it is rounded only
/// once.
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

/// The exponent where a unit is a power of ten of a metre; otherwise nullopt.
std::optional<int> power_of(const NamedUnit& unit) {
  int power = 0;
  std::uint32_t above = unit.numerator, below = unit.denominator;
  for (; above % 10 == 0; above /= 10) ++power;
  for (; below % 10 == 0; below /= 10) --power;
  return above == 1 && below == 1 ? std::optional(power) : std::nullopt;
}

std::optional<double> length_in(std::string_view digits, const NamedUnit& unit) {
  if (const auto power = power_of(unit)) return shifted(digits, *power);
  const auto value = number_of(digits);
  if (!value) return std::nullopt;
  return static_cast<double>(static_cast<long double>(*value) * unit.numerator / unit.denominator);
}

/// A length in international feet; "0.2ft" gives the double nearest to 0.2.
double feet_in(double number, const NamedUnit& unit) {
  constexpr long double kFoot = 3048, kTenThousand = 10'000;
  return static_cast<double>(number * (unit.numerator * kTenThousand / unit.denominator) / kFoot);
}

std::optional<ParsedLength> parsed(std::string_view text) {
  while (text.starts_with(' ')) text.remove_prefix(1);
  while (text.ends_with(' ')) text.remove_suffix(1);
  const std::size_t last_digit = text.find_last_of("0123456789.");
  if (last_digit == std::string_view::npos) return std::nullopt;
  std::string_view unit = text.substr(last_digit + 1);
  std::string_view digits = text.substr(0, last_digit + 1);
  if (digits.starts_with('+') && !digits.starts_with("+-")) digits.remove_prefix(1);
  while (unit.starts_with(' ')) unit.remove_prefix(1);
  if (unit.empty()) {
    const auto value = number_of(digits);
    return value ? std::optional(ParsedLength{.value = *value, .number = *value}) : std::nullopt;
  }
  const NamedUnit* const known = find_unit(unit);
  const auto number = number_of(digits);
  if (known == nullptr || !number) return std::nullopt;
  const auto value = length_in(digits, *known);
  if (!value) return std::nullopt;
  return ParsedLength{.value = *value,
                      .has_unit = true,
                      .feet = feet_in(*number, *known),
                      .number = *number,
                      .unit = known->file_unit()};
}

}  // namespace

double ParsedLength::in_units_of(double metres) const {
  if (!has_unit) return value;
  if (unit.is_any_foot() && is_foot(metres)) return number;
  return metres == kMetresPerFoot ? feet : value / metres;
}

std::optional<ParsedLength> length_of(std::string_view text) {
  const auto length = parsed(text);
  return length && std::isfinite(length->value) ? length : std::nullopt;
}

}  // namespace clearway
