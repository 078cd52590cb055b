#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace clearway {

/// What a text says of a length: "0.1", "10cm", "4 in".
struct ParsedLength {
  double value = 0;       ///< metres where a unit was given
  bool has_unit = false;  ///< otherwise the unit is that of the file it is compared with
  double feet = 0;        ///< the same, where a unit was given

  /// In a unit of so many metres.
  double in_units_of(double metres) const;
};

/// A number, alone or with mm, cm, m, km, in or ft behind it; none where the text is anything else,
/// or not finite. A decimal becomes the nearest double, "10cm" the same as "0.1".
std::optional<ParsedLength> length_of(std::string_view text);

/// Names of units that files are written in.
std::vector<std::string> file_unit_names();

/// Metres of such a unit; none for another name.
std::optional<double> metres_of_file_unit(std::string_view name);

}  // namespace clearway
