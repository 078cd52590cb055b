#include "cli/support/lengths.hpp"

#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

#include "clearway/model.hpp"
#include "io/formats/text/column_names.hpp"
#include "io/formats/wkt.hpp"

namespace clearway::tool {
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

std::optional<ParsedLength> parse(std::string_view text) {
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

/// expected: for the error.
template <std::size_t kCount>
std::array<ParsedLength, kCount> parse_lengths(const std::string& option, const std::string& text,
                                               const char* expected) {
  std::array<ParsedLength, kCount> out{};
  std::vector<std::string_view> fields;
  split_fields(text, ',', fields);
  bool good = fields.size() == out.size();
  for (std::size_t k = 0; good && k < out.size(); ++k) {
    const auto length = parse(fields[k]);
    good = length && std::isfinite(length->value);
    if (good) out[k] = *length;
  }
  if (good) return out;
  throw CLI::ValidationError(option, text + ": expected " + expected);
}

/// Metres of the unit that well-known text names; 1 where it names none.
double metres_of_crs(const std::string& wkt) {
  const double metres = metres_of(units_of_wkt(wkt).horizontal);
  return metres > 0 ? metres : 1;
}

}  // namespace

double ParsedLength::in_units_of(double metres) const {
  if (!has_unit) return value;
  return metres == kMetresPerFoot ? feet : value / metres;
}

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

std::optional<double> metres_of_unit(const std::string& length_unit) {
  const double metres = metres_of(length_unit_of(length_unit));
  return metres > 0 && metres != 1 ? std::optional(metres) : std::nullopt;
}

std::string symbol_of_unit(const std::string& length_unit) {
  const LengthUnit unit = length_unit_of(length_unit);
  return symbol_of(unit == LengthUnit::kDegrees ? LengthUnit::kMetre : unit);
}

CLI::Option* add_unit_option(CLI::App& command, const std::string& names, double& metres,
                             const std::string& description) {
  std::vector<std::string> known;
  for (const Unit& unit : kUnits) {
    if (unit.of_files) known.emplace_back(unit.name);
  }
  return command
      .add_option_function<std::string>(
          names,
          [&metres](const std::string& name) {
            metres = std::ranges::find(kUnits, name, &Unit::name)->metres;
          },
          description)
      ->type_name("UNIT")
      ->check(CLI::IsMember(known));
}

CLI::Option* LengthOptions::add(CLI::App& command, const std::string& name, double& length,
                                const std::string& description, LengthRange range) {
  return command
      .add_option_function<std::string>(
          name,
          [this, &length, name, range](const std::string& text) {
            set(length, parse_length(name, text, range));
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
            set(length.emplace(), parse_length(name, text, range));
          },
          description)
      ->type_name("METRES");
}

CLI::Option* LengthOptions::add(CLI::App& command, const std::string& name, Vec3& lengths,
                                const std::string& description) {
  return command
      .add_option_function<std::string>(
          name,
          [this, &lengths, name](const std::string& text) {
            const auto parsed = parse_lengths<3>(
                name, text,
                "three numbers of metres, for example 1.2,0,1.5, or with units, for example "
                "120cm,0,1.5m");
            for (int k = 0; k < 3; ++k) set(lengths[k], parsed[static_cast<std::size_t>(k)]);
          },
          description)
      ->type_name("X,Y,Z");
}

CLI::Option* LengthOptions::add(CLI::App& command, const std::string& name,
                                std::optional<std::array<double, 2>>& lengths,
                                const std::string& description) {
  return command
      .add_option_function<std::string>(
          name,
          [this, &lengths, name](const std::string& text) {
            const auto parsed = parse_lengths<2>(
                name, text, "two numbers of metres, for example 10,-10, or with units");
            lengths.emplace();
            for (std::size_t k = 0; k < 2; ++k) set((*lengths)[k], parsed[k]);
          },
          description)
      ->type_name("A,B");
}

void LengthOptions::set(double& length, const ParsedLength& parsed) {
  length = parsed.value;
  if (parsed.has_unit) with_unit_.emplace_back(&length, parsed);
}

void LengthOptions::convert(double metres) const {
  for (const auto& [length, parsed] : with_unit_) *length = parsed.in_units_of(metres);
}

double LengthOptions::convert_for(const std::string& result, const std::string& crs_wkt) const {
  const double metres = metres_of_crs(crs_wkt);
  if (crs_wkt.empty() && !with_unit_.empty()) {
    spdlog::warn(
        "{}: has no CRS, so its coordinates are taken for metres; where the scan is in "
        "feet, give lengths without a unit",
        result);
  }
  convert(metres);
  return metres;
}

void add_chainage_option(CLI::App& command, LengthOptions& lengths, double& start) {
  lengths.add(command, "--chainage-start", start, "Chainage of the first pose (default: 0)",
              LengthRange::kAny);
}

}  // namespace clearway::tool
