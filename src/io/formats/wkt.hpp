#pragma once

#include <string>
#include <string_view>

#include "io/formats/length_unit.hpp"

namespace clearway {

/// A unit as a file names it.
struct StatedUnit {
  LengthUnit unit = LengthUnit::kUnknown;
  std::string other;  ///< where one is named that is none of ours: which one
};

/// metres: of the unit.
StatedUnit unit_of_length(double metres);

/// What a coordinate reference system says of lengths.
struct CrsUnits {
  LengthUnit horizontal = LengthUnit::kUnknown;
  /// Why coordinates cannot be taken as they are, "its unit is 1000 m"; empty where they can.
  std::string trouble;
  /// What the file says against `horizontal`, as a sentence without its end; empty: nothing.
  std::string doubt = {};
};

/// Of a coordinate reference system in well-known text 1 or 2; unknown where the text does not say
/// or cannot be parsed. Source: OGC 01-009 and OGC 18-010.
CrsUnits units_of_wkt(std::string_view wkt);

/// Of a system with these units.
CrsUnits crs_units(const StatedUnit& plane, const StatedUnit& heights);

}  // namespace clearway
