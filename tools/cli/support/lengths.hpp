#pragma once

#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace clearway::tool {

/// What a text says of a length above 0: "0.1", "10cm", "4 in".
struct ParsedLength {
  double value = 0;       ///< metres where a unit was given
  bool has_unit = false;  ///< otherwise the unit is that of the file it is compared with
};

/// Which lengths an option takes.
enum class LengthRange { kAboveZero, kFromZero, kAny };

/// Throws CLI::ValidationError naming the option where the text is no finite length of the range. A
/// decimal becomes the nearest double, "10cm" the same as "0.1".
ParsedLength parse_length(const std::string& option, const std::string& text,
                          LengthRange range = LengthRange::kAboveZero);

/// Lengths of a command line that were given with a unit, for an environment that is not in metres.
class LengthOptions {
 public:
  /// An option that takes a length; both outlive the command.
  CLI::Option* add(CLI::App& command, const std::string& name, double& length,
                   const std::string& description, LengthRange range = LengthRange::kAboveZero);
  /// The same of one that need not be given.
  CLI::Option* add(CLI::App& command, const std::string& name, std::optional<double>& length,
                   const std::string& description, LengthRange range);

  /// Turns those that were given in metres into units of `metres` metres.
  void convert(double metres) const;

 private:
  std::vector<double*> in_metres_;
  std::vector<std::optional<double>*> optional_in_metres_;
};

}  // namespace clearway::tool
