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

/// A unit of length as people and files name it. This table is the only one: every option, header
/// and file that names a unit of length is read by it.
struct NamedUnit {
  std::string_view symbol;                  ///< as options take it, for example "us-ft"
  std::span<const std::string_view> names;  ///< other names, lower case
  std::uint32_t numerator, denominator;     ///< metres, as a fraction
  LengthUnit environment;  ///< what an environment in it is in; kUnknown: no scan is read in it
  bool of_files;           ///< whether models and trajectories are read in it
  bool any_foot = false;   ///< see FileUnit

  double metres() const { return static_cast<double>(numerator) / denominator; }
  FileUnit file_unit() const { return any_foot ? metres() : FileUnit::exactly(metres()); }
};

/// By its symbol or another of its names, which are lower case; null for any other text.
const NamedUnit* find_unit(std::string_view name);

/// Symbols of the units that models and trajectories are read in.
std::vector<std::string> file_unit_names();
/// The same in a sentence: "mm, cm, m, in, ft, ift or us-ft".
std::string file_unit_list();
/// A unit that models and trajectories are read in; none for another name.
std::optional<FileUnit> file_unit_of(std::string_view name);

/// "unknown", "metre", "foot", "us-survey-foot", "degree".
std::string to_string(LengthUnit unit);
/// kUnknown for any other text.
LengthUnit length_unit_of(const std::string& name);
/// "m", "ft", "US ft", "deg"; metres where it is not known.
const char* symbol_of(LengthUnit unit);
/// For people: "feet" for both feet, "metres", "degrees".
const char* plural_of(LengthUnit unit);
/// 0 for those that are no lengths of a known size.
double metres_of(LengthUnit unit);
/// A foot of any country.
bool is_foot(double metres);
/// The warning "unit-assumed" on a file in units of `metres`. whose: for example "path.csv: its
/// positions".
std::string unit_assumed_text(const std::string& whose, double metres);
/// How far coordinates move when they are taken from one foot into the other, metres. largest: the
/// greatest coordinate, metres.
double feet_apart(double largest, double metres, double other);
/// Beyond this distance, in metres, it matters which foot was meant.
inline constexpr double kFeetApart = 0.0005;
/// The warning about it. whose: for example "path.csv: its positions".
std::string two_feet_text(const std::string& whose, double metres, double environment_unit,
                          double moved);
/// "US survey feet", "feet" or "units of 0.001 m".
std::string units_text(double metres);

}  // namespace clearway
