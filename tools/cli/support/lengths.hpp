#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "clearway/store.hpp"
#include "clearway/vec3.hpp"
#include "io/formats/text/length_text.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace clearway::tool {

/// Which lengths an option takes.
enum class LengthRange { kAboveZero, kFromZero, kAny };

/// Throws CLI::ValidationError naming the option where the text is no finite length of the range. A
/// decimal becomes the nearest double, "10cm" the same as "0.1".
ParsedLength parse_length(const std::string& option, const std::string& text,
                          LengthRange range = LengthRange::kAboveZero);

/// What follows a length in the unit of a store's coordinates, by its name there. Degrees are
/// warned of elsewhere, and count as metres here.
std::string symbol_of_unit(const std::string& length_unit);

/// Tells the readers of models and trajectories what the environment is in.
template <typename... Options>
void set_environment_unit(const Store& store, Options&... options) {
  ((options.environment_unit = store.metres_per_unit()), ...);
  ((options.environment_unit_is_assumed = store.length_unit() == "unknown"), ...);
}

/// An option that takes the name of a unit of a file.
CLI::Option* add_unit_option(CLI::App& command, const std::string& names, FileUnit& unit,
                             const std::string& description);

/// What the help calls the value of an option that takes one length.
inline constexpr const char* kLengthType = "METRES";

/// Lengths of a command line that were given with a unit, for an environment that is not in metres.
class LengthOptions {
 public:
  /// An option that takes a length; both outlive the command.
  CLI::Option* add(CLI::App& command, const std::string& name, double& length,
                   const std::string& description, LengthRange range = LengthRange::kAboveZero);
  /// The same of one that need not be given.
  CLI::Option* add(CLI::App& command, const std::string& name, std::optional<double>& length,
                   const std::string& description, LengthRange range);

  /// The same for three lengths X,Y,Z, which may be 0 or negative.
  CLI::Option* add(CLI::App& command, const std::string& name, Vec3& lengths,
                   const std::string& description);

  /// The same for two lengths A,B, which may be 0 or negative and need not be given.
  CLI::Option* add(CLI::App& command, const std::string& name,
                   std::optional<std::array<double, 2>>& lengths, const std::string& description);

  /// Turns those that were given with a unit into units of `metres` metres.
  void convert(double metres) const;
  /// The same for a store. Where it names no unit, a length in feet or inches is a sign that the
  /// scan is not in metres, and warned of.
  std::optional<Message> convert_for(const Store& store) const;
  /// The same for a result, whose unit its CRS tells. Gives metres of the unit. Warns where there
  /// is no CRS and a length was given with a unit: the scan may have a unit all the same.
  double convert_for(const std::string& result, const std::string& crs_wkt) const;

 private:
  void set(double& length, const ParsedLength& parsed);

  std::vector<std::pair<double*, ParsedLength>> with_unit_;
};

/// --chainage-start.
void add_chainage_option(CLI::App& command, LengthOptions& lengths, double& start);

}  // namespace clearway::tool
