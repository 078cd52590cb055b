#pragma once

#include <optional>
#include <string_view>

#include "clearway/file_unit.hpp"

namespace clearway {

/// What a text says of a length: "0.1", "10cm", "4 in", "0.5 us-ft".
struct ParsedLength {
  double value = 0;       ///< metres where a unit was given, otherwise the number
  bool has_unit = false;  ///< otherwise the unit is that of the file it is compared with
  double feet = 0;        ///< in international feet, where a unit was given
  double number = 0;      ///< as written
  FileUnit unit = {};     ///< as written

  /// In a unit of so many metres. A length in feet is in the same foot where that unit is one.
  double in_units_of(double metres) const;
};

/// A number, alone or with the name of a unit of length behind it; none where the text is anything
/// else, or not finite. A decimal becomes the nearest double, "10cm" the same as "0.1".
std::optional<ParsedLength> length_of(std::string_view text);

}  // namespace clearway
