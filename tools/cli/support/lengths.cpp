#include "cli/support/lengths.hpp"

#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "cli/support/options.hpp"
#include "core/messages/messages.hpp"
#include "io/result/result_header.hpp"
#include "io/scans/length_unit.hpp"
#include "io/scans/scan_crs.hpp"
#include "io/scans/text/text_table.hpp"

namespace clearway::tool {
namespace {

/// What help texts and errors call one, two, three or four lengths.
struct LengthNames {
  const char* type;
  const char* expected = "";
};

constexpr std::array kLengthNames{
    LengthNames{kLengthType},
    LengthNames{"A,B", "two numbers of metres, for example 10,-10, or with units"},
    LengthNames{"X,Y,Z",
                "three numbers of metres, for example 1.2,0,1.5, or with units, for example "
                "120cm,0,1.5m"},
    LengthNames{"A,B,C,D", "four numbers of metres, for example -4,4,0,6, or with units"}};

/// Reads a length of the range, or so many lengths with commas between them. Throws
/// CLI::ValidationError.
std::vector<ParsedLength> parse_lengths(const std::string& option, const std::string& text,
                                        std::size_t count, FieldRange range) {
  if (count == 1) return {parse_length(option, text, range)};
  std::vector<std::string_view> fields;
  split_fields(text, ',', fields);
  std::vector<ParsedLength> lengths;
  for (const std::string_view field : fields) {
    if (const auto length = length_of(field)) lengths.push_back(*length);
  }
  if (fields.size() == count && lengths.size() == count) return lengths;
  throw CLI::ValidationError(option, text + ": expected " + kLengthNames[count - 1].expected);
}

/// Metres per unit of the CRS that well-known text describes; 1 where it names no unit.
double metres_of_crs(const std::string& wkt) {
  const double metres = metres_of(unit_of_crs(wkt));
  return metres > 0 ? metres : 1;
}

}  // namespace

std::string expected_length(FieldRange range) {
  const char* limit = range == FieldRange::kAboveZero  ? " above 0"
                      : range == FieldRange::kFromZero ? ", 0 or more"
                                                       : "";
  return std::string("expected a finite number of metres") + limit +
         ", for example 0.1, or a number with a unit (mm, cm, m, km, in, ft, ift or us-ft), for "
         "example 10cm";
}

ParsedLength parse_length(const std::string& option, const std::string& text, FieldRange range) {
  if (const auto length = length_of(text)) {
    const double value = length->value;
    if (range == FieldRange::kAny || value > 0) return *length;
    if (range == FieldRange::kFromZero && value == 0) return *length;
  }
  throw CLI::ValidationError(option, text + ": " + expected_length(range));
}

std::string symbol_of_unit(const std::string& length_unit) {
  const LengthUnit unit = length_unit_of(length_unit);
  return symbol_of(unit == LengthUnit::kDegrees ? LengthUnit::kMetre : unit);
}

CLI::Option* add_unit_option(CLI::App& command, const std::string& names, FileUnit& unit,
                             const std::string& description) {
  return command
      .add_option_function<std::string>(
          names, [&unit](const std::string& name) { unit = FileUnit::named(name); }, description)
      ->type_name("UNIT")
      ->check(CLI::IsMember(file_unit_names()));
}

CLI::Option* LengthOptions::add_numbers(CLI::App& command, const std::string& name,
                                        std::size_t count, const std::function<Numbers()>& numbers,
                                        const std::string& description, FieldRange range) {
  const auto read = [this, name, count, numbers, range](const std::string& text) {
    const std::vector<ParsedLength> lengths = parse_lengths(name, text, count, range);
    const Numbers into = numbers();
    for (std::size_t i = 0; i < count; ++i) {
      *into[i] = lengths[i].value;
      if (lengths[i].has_unit) with_unit_.emplace_back(into[i], lengths[i]);
      if (!lengths[i].has_unit && lengths[i].value != 0) lacks_unit_ = true;
    }
  };
  return command.add_option_function<std::string>(name, read, description)
      ->type_name(kLengthNames[count - 1].type);
}

void LengthOptions::convert(double metres) const {
  for (const auto& [length, parsed] : with_unit_) *length = parsed.in_units_of(metres);
}

std::optional<Message> LengthOptions::convert_for(const Store& store) const {
  convert(store.metres_per_unit());
  const LengthUnit unit = length_unit_of(store.length_unit());
  const bool in_ft = std::ranges::any_of(
      with_unit_, [](const auto& length) { return length.second.unit.is_any_foot(); });
  if (in_ft && unit == LengthUnit::kUsSurveyFoot) {
    spdlog::info("lengths in ft are in the environment's foot, the US survey foot");
  }
  if (unit != LengthUnit::kUnknown) return std::nullopt;
  for (const auto& [length, parsed] : with_unit_) {
    const bool of_ten = parsed.unit == FileUnit(kMetresPerMillimetre) ||
                        parsed.unit == FileUnit(kMetresPerCentimetre) || parsed.unit.metres() >= 1;
    if (of_ten || parsed.unit == FileUnit(0.1)) continue;
    return warning("unit-assumed",
                   unit_assumed_text("lengths of the command", parsed.unit.metres()),
                   {{"metres", parsed.unit.metres()}});
  }
  return std::nullopt;
}

double LengthOptions::convert_for(const std::string& file, const std::string& crs_wkt,
                                  const std::string& length_unit) const {
  const LengthUnit unit = length_unit_of(length_unit);
  const bool is_known = unit != LengthUnit::kUnknown;
  double metres = metres_of_crs(crs_wkt);
  if (is_known) metres = unit == LengthUnit::kDegrees ? 1 : metres_of(unit);
  if (!is_known && crs_wkt.empty() && !with_unit_.empty()) {
    spdlog::warn(
        "{}: has no CRS, so its coordinates are taken for metres; where the scan is in "
        "feet, give lengths without a unit",
        file);
  }
  convert(metres);
  return metres;
}

double LengthOptions::convert_for(const std::filesystem::path& file,
                                  const ResultHeader& header) const {
  return convert_for(file.string(), header.crs_wkt, header.notes.length_unit);
}

bool names_unit(const FileUnit& option, std::span<const Message> messages) {
  return option.is_known() || std::ranges::any_of(messages, [](const Message& message) {
           return message.code != "datum-accuracy" &&
                  std::ranges::any_of(message.numbers,
                                      [](const auto& number) { return number.first == "metres"; });
         });
}

std::optional<Message> note_on_feet(const Store& store) {
  if (!is_foot(store.metres_per_unit())) return std::nullopt;
  return note("feet",
              "the environment is in feet; the lengths, the model and the trajectory name their "
              "units, so nothing is assumed");
}

void add_chainage_option(CLI::App& command, LengthOptions& lengths, double& start) {
  lengths
      .add(command, "--chainage-start", start, "Chainage of the first pose (default: 0)",
           FieldRange::kAny)
      ->group(title_of(OptionGroup::kConflicts));
}

}  // namespace clearway::tool
