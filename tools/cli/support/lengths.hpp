#pragma once

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

/// Throws CLI::ValidationError naming the option where the text is no finite length above 0. A
/// decimal becomes the nearest double, "10cm" the same as "0.1".
ParsedLength parse_length(const std::string& option, const std::string& text);

/// Lengths of a command line that were given with a unit, for an environment that is not in metres.
class LengthOptions {
 public:
  /// An option that takes a length; both outlive the command.
  CLI::Option* add(CLI::App& command, const std::string& name, double& length,
                   const std::string& description);

  /// Turns those that were given in metres into units of `metres` metres.
  void convert(double metres) const;

 private:
  std::vector<double*> in_metres_;
};

}  // namespace clearway::tool
