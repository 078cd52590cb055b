#pragma once

#include <string>
#include <string_view>

#include "io/formats/length_unit.hpp"

namespace clearway {

/// A unit as a file names it.
struct StatedUnit {
  LengthUnit unit = LengthUnit::kUnknown;
  std::string other;  ///< name of a unit that is not a LengthUnit; otherwise empty
};

/// The unit of so many metres.
StatedUnit unit_of_length(double metres);

/// The units of length that a coordinate reference system states.
struct CrsUnits {
  LengthUnit horizontal = LengthUnit::kUnknown;
  /// Why coordinates cannot be used as they are, as in "its unit is 1000 m"; empty where they can.
  std::string trouble;
  /// What in the file contradicts `horizontal`, as a sentence without its full stop; empty where
  /// nothing does.
  std::string doubt = {};
};

/// The units of a coordinate reference system in well-known text 1 or 2; unknown where the text
/// does not state them or cannot be parsed. Source: OGC 01-009 and OGC 18-010.
CrsUnits units_of_wkt(std::string_view wkt);

/// Judges a system whose plane and heights have these units.
CrsUnits crs_units(const StatedUnit& plane, const StatedUnit& heights);

}  // namespace clearway
