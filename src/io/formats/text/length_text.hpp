#pragma once

#include <optional>
#include <string_view>

#include "clearway/file_unit.hpp"

namespace clearway {

/// A length given as text: "0.1", "10cm", "4 in", "0.5 us-ft".
struct ParsedLength {
  double value = 0;  ///< metres where a unit was given, otherwise the number
  /// Whether a unit was given; otherwise the number is in the unit of the file it is compared with.
  bool has_unit = false;
  double feet = 0;     ///< the length in international feet, where a unit was given
  double number = 0;   ///< the number as written
  FileUnit unit = {};  ///< the unit as written

  /// The length in a unit of so many metres. A length in "ft", which may be any foot, is taken to
  /// be in that unit where the unit is a foot.
  double in_units_of(double metres) const;
};

/// Parses a number, alone or followed by the name of a unit of length; nullopt where the text is
/// anything else or not finite. A decimal becomes the nearest double, so "10cm" gives the same as
/// "0.1".
std::optional<ParsedLength> length_of(std::string_view text);

}  // namespace clearway
