#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "clearway/file_unit.hpp"

namespace clearway {

/// The unit of an environment's coordinates.
enum class LengthUnit { kUnknown, kMetre, kFoot, kUsSurveyFoot, kDegrees };

/// A unit of length as people and files name it. All options, headers and files that name a unit of
/// length are read by this one table.
struct NamedUnit {
  std::string_view symbol;                  ///< name in options, for example "us-ft"
  std::span<const std::string_view> names;  ///< other names, lower case
  std::uint32_t numerator, denominator;     ///< the unit in metres, as a fraction
  /// Unit of an environment given in it; kUnknown where no scan is read in this unit.
  LengthUnit environment;
  bool of_files;          ///< whether models and trajectories are read in this unit
  bool any_foot = false;  ///< see FileUnit

  double metres() const { return static_cast<double>(numerator) / denominator; }
  FileUnit file_unit() const { return any_foot ? metres() : FileUnit::exactly(metres()); }
};

/// Finds a unit by its symbol or another of its names, all in lower case; null for any other text.
const NamedUnit* find_unit(std::string_view name);

/// Finds a unit of environments by a name that stands among other words, as in "NAD83 / Texas South
/// Central (ftUS)"; null where there is none. Single letters do not count.
const NamedUnit* find_unit_in_words(std::string_view text);

/// Symbols of the units in which models and trajectories are read.
std::vector<std::string> file_unit_names();
/// Symbols of the units in which models and trajectories are read, as in "mm, cm, m, in, ft, ift or
/// us-ft".
std::string file_unit_list();
/// The unit of this name in which models and trajectories are read; nullopt for another name.
std::optional<FileUnit> file_unit_of(std::string_view name);

/// The symbol by which file_unit_of() finds a unit, for example "us-ft"; empty where it has none.
std::string symbol_of(const FileUnit& unit);

/// A length that somebody chose, for messages, such as "0.492125": all of its digits but those that
/// converting units leaves behind.
std::string format_length(double length);

/// Start of the comment in PLY and OFF files of Clearway that says the unit of their coordinates. A
/// name that file_unit_of() reads follows.
inline constexpr std::string_view kUnitComment = "clearway unit ";

/// The name of a unit: "unknown", "metre", "foot", "us-survey-foot" or "degree".
std::string to_string(LengthUnit unit);
/// The unit with a name that to_string() gives; kUnknown for any other text.
LengthUnit length_unit_of(const std::string& name);
/// The symbol of a unit: "m", "ft", "US ft" or "deg"; "m" where the unit is not known.
const char* symbol_of(LengthUnit unit);
/// The plural of a unit for messages: "metres", "feet", "US survey feet" or "degrees".
const char* plural_of(LengthUnit unit);
/// Well-known text of a local system in this unit, for coordinates without a CRS; in metres where
/// the unit is not known.
std::string local_system(LengthUnit unit);
/// The length of a unit in metres; 0 for unknown and for degrees.
double metres_of(LengthUnit unit);
/// Whether a unit of this many metres is a foot of any country.
bool is_foot(double metres);
/// Text of the warning "unit-assumed" about a file in units of `metres`. whose: for example
/// "path.csv: its positions".
std::string unit_assumed_text(const std::string& whose, double metres);
/// Metres that coordinates move when they are converted with one foot instead of the other.
/// largest: the greatest coordinate in metres. metres, other: the two feet.
double feet_apart(double largest, double metres, double other);
/// Distance in metres beyond which it matters which foot was meant.
inline constexpr double kFeetApart = 0.0005;
/// Text of the warning that positions in one foot were converted for an environment in another.
/// whose: for example "path.csv: its positions". moved: metres that this moves them, see
/// feet_apart().
std::string two_feet_text(const std::string& whose, double metres, double environment_unit,
                          double moved);
/// The unit in words: "metres", "international feet", "US survey feet" or "units of 0.001 m".
std::string units_text(double metres);

}  // namespace clearway
