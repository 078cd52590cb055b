#include "io/scans/length_unit.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "clearway/error.hpp"
#include "core/util/format.hpp"
#include "io/scans/formatted_message.hpp"

namespace clearway {
namespace {

using Names = std::span<const std::string_view>;

constexpr std::string_view kMillimetres[] = {"millimetre", "millimetres", "millimeter",
                                             "millimeters"};
constexpr std::string_view kCentimetres[] = {"centimetre", "centimetres", "centimeter",
                                             "centimeters"};
constexpr std::string_view kDecimetres[] = {"decimetre", "decimetres", "decimeter", "decimeters"};
constexpr std::string_view kMetres[] = {"metre", "metres", "meter", "meters"};
constexpr std::string_view kKilometres[] = {"kilometre", "kilometres", "kilometer", "kilometers"};
constexpr std::string_view kInches[] = {"inch", "inches", "\""};
constexpr std::string_view kFeet[] = {"foot", "feet"};
constexpr std::string_view kInternationalFeet[] = {"intl-ft",
                                                   "intl_ft",
                                                   "int-ft",
                                                   "ft(intl)",
                                                   "intl ft",
                                                   "ftint",
                                                   "international foot",
                                                   "international feet",
                                                   "international-foot",
                                                   "international-feet"};
constexpr std::string_view kSurveyFeet[] = {
    "usft",           "us_ft",          "us ft",          "ftus",
    "ft(us)",         "ft-us",          "ft_us",          "sft",
    "us survey foot", "us survey feet", "us-survey-foot", "us-survey-feet",
    "us_survey_foot", "us_survey_feet", "survey foot",    "survey feet",
    "foot_us",        "foot us",        "feet us",        "us feet"};
constexpr std::string_view kYards[] = {"yard", "yards"};

constexpr std::array<NamedUnit, 10> kNamed{
    {{"mm", kMillimetres, 1, 1000, LengthUnit::kUnknown, true},
     {"cm", kCentimetres, 1, 100, LengthUnit::kUnknown, true},
     {"m", kMetres, 1, 1, LengthUnit::kMetre, true},
     {"in", kInches, 254, 10'000, LengthUnit::kUnknown, true},
     {"ft", kFeet, 3048, 10'000, LengthUnit::kFoot, true, true},
     {"ift", kInternationalFeet, 3048, 10'000, LengthUnit::kFoot, true},
     {"us-ft", kSurveyFeet, 1200, 3937, LengthUnit::kUsSurveyFoot, true},
     {"dm", kDecimetres, 1, 10, LengthUnit::kUnknown, false},
     {"km", kKilometres, 1000, 1, LengthUnit::kUnknown, false},
     {"yd", kYards, 9144, 10'000, LengthUnit::kUnknown, false}}};

struct EnvironmentUnit {
  const char *name, *symbol, *plural;
  double metres;
};

/// The units of environments, in the order of LengthUnit.
constexpr std::array<EnvironmentUnit, 5> kUnits{
    {{"unknown", "m", "metres", 0},
     {"metre", "m", "metres", 1},
     {"foot", "ft", "feet", kMetresPerFoot},
     {"us-survey-foot", "US ft", "US survey feet", kMetresPerUsSurveyFoot},
     {"degree", "deg", "degrees", 0}}};

const EnvironmentUnit& of(LengthUnit unit) { return kUnits[static_cast<std::size_t>(unit)]; }

/// Whether both lengths in metres are the same unit, which files may give with few digits.
bool are_same(double metres, double other) {
  // The tolerance separates the two feet, which differ by 2e-6 of their length, and accepts
  // 0.3048006 as the survey foot.
  return std::abs(metres - other) < 5e-7 * other;
}

}  // namespace

FileUnit FileUnit::named(std::string_view name) {
  if (const auto unit = file_unit_of(name)) return *unit;
  throw UsageError(fmt::format("\"{}\" is no unit of length; expected {}", name, file_unit_list()));
}

double FileUnit::metres_in(double environment_unit) const {
  const bool same = any_foot_ ? is_foot(environment_unit) : are_same(metres_, environment_unit);
  return same ? environment_unit : metres_;
}

const NamedUnit* find_unit(std::string_view name) {
  const auto* const unit = std::ranges::find_if(kNamed, [name](const NamedUnit& known) {
    return known.symbol == name || std::ranges::find(known.names, name) != known.names.end();
  });
  return unit == kNamed.end() ? nullptr : unit;
}

const NamedUnit* find_unit_in_words(std::string_view text) {
  constexpr std::size_t kMostWords = 3;  // as in "us survey foot"
  std::vector<std::string> words(1);
  for (char c : text) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    const bool is_letter = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
    if (is_letter) words.back() += c;
    if (!is_letter && !words.back().empty()) words.emplace_back();
  }
  for (std::size_t count = kMostWords; count > 0; --count) {
    for (std::size_t first = 0; first + count <= words.size(); ++first) {
      std::string name = words[first];
      for (std::size_t i = 1; i < count; ++i) name += " " + words[first + i];
      const NamedUnit* const unit = name.size() > 1 ? find_unit(name) : nullptr;
      if (unit != nullptr && unit->environment != LengthUnit::kUnknown) return unit;
    }
  }
  return nullptr;
}

std::vector<std::string> file_unit_names() {
  std::vector<std::string> names;
  for (const NamedUnit& unit : kNamed) {
    if (unit.of_files) names.emplace_back(unit.symbol);
  }
  return names;
}

std::string file_unit_list() {
  const std::vector<std::string> names = file_unit_names();
  std::string list;
  for (std::size_t i = 0; i < names.size(); ++i) {
    list += (i == 0 ? "" : i + 1 == names.size() ? " or " : ", ") + names[i];
  }
  return list;
}

std::optional<FileUnit> file_unit_of(std::string_view name) {
  const NamedUnit* const unit = find_unit(name);
  return unit != nullptr && unit->of_files ? std::optional(unit->file_unit()) : std::nullopt;
}

std::string symbol_of(const FileUnit& unit) {
  const auto* const found = std::ranges::find_if(kNamed, [&](const NamedUnit& known) {
    return known.of_files && known.any_foot == unit.is_any_foot() &&
           are_same(unit.metres(), known.metres());
  });
  return found == kNamed.end() ? std::string() : std::string(found->symbol);
}

std::string format_length(double length) { return format_digits(length, 9); }

std::string to_string(LengthUnit unit) { return of(unit).name; }

LengthUnit length_unit_of(const std::string& name) {
  const auto unit = std::ranges::find(kUnits, name, &EnvironmentUnit::name);
  return unit == kUnits.end() ? LengthUnit::kUnknown
                              : static_cast<LengthUnit>(unit - kUnits.begin());
}

const char* symbol_of(LengthUnit unit) { return of(unit).symbol; }

const char* plural_of(LengthUnit unit) { return of(unit).plural; }

std::string local_system(LengthUnit unit) {
  const double metres = metres_of(unit);
  const char* name = metres == 0 || metres == 1  ? "metre"
                     : unit == LengthUnit::kFoot ? "foot"
                                                 : "US survey foot";
  return std::string("LOCAL_CS[\"unknown\",UNIT[\"") + name + "\"," +
         (metres == 0 ? "1" : format_number(metres)) + "]]";
}

double metres_of(LengthUnit unit) { return of(unit).metres; }

bool is_foot(double metres) {
  // Relative tolerance that covers all feet from Clarke's to the US survey foot.
  constexpr double kOfCountries = 2e-5;
  return std::abs(metres - kMetresPerFoot) < kOfCountries * kMetresPerFoot;
}

std::string unit_assumed_text(const std::string& whose, double metres) {
  return whose + " are in " + units_text(metres) +
         " and were converted to metres, because the environment names no unit and is taken to be "
         "in metres. Convert the scan with --unit, which names its unit";
}

double feet_apart(double largest, double metres, double other) {
  return largest * std::abs(metres - other) / other;
}

std::string two_feet_text(const std::string& whose, double metres, double environment_unit,
                          double moved) {
  return whose + " are in " + units_text(metres) + ", the environment is in " +
         units_text(environment_unit) + ". They were converted, which moves them by up to " +
         format_brief(moved) + " m. If they are in the environment's foot, give their unit as ft";
}

std::string units_text(double metres) {
  for (const LengthUnit unit : {LengthUnit::kMetre, LengthUnit::kFoot, LengthUnit::kUsSurveyFoot}) {
    if (are_same(metres, metres_of(unit))) {
      return unit == LengthUnit::kFoot ? "international feet" : plural_of(unit);
    }
  }
  return "units of " + format_brief(metres) + " m";
}

}  // namespace clearway
