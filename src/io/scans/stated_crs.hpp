#pragma once

#include <string>
#include <string_view>

#include "io/scans/length_unit.hpp"

namespace clearway {

/// What a scan's file says of its coordinate reference system and of its units of length.
struct StatedCrs {
  /// Text as found in the file, in UTF-8; empty where the file has none.
  std::string crs_wkt = {};
  /// The system in a form that PROJ reads: crs_wkt, or what GeoTIFF keys name, such as
  /// "EPSG:25832". Empty where the file names none, or one that is not read.
  std::string crs = {};
  LengthUnit unit = LengthUnit::kUnknown;  ///< unit of the horizontal coordinates
  bool any_foot = false;   ///< whether the unit is "ft", which does not say which foot it is
  double height_unit = 0;  ///< metres per unit of the heights, where the file names it; otherwise 0
  std::string unit_trouble =
      {};  ///< why coordinates cannot be used as they are; empty where they can
  std::string unit_doubt = {};  ///< what contradicts the unit; empty where nothing does
  /// What the file says of its system that is not read, so that its units are not known; empty
  /// where all is read.
  std::string crs_unread = {};
  /// What the file says of its system that is not read, although its units are known; empty where
  /// all is read.
  std::string crs_doubt = {};
  /// What the file says of its unit that is not read, while nothing else names a unit; otherwise
  /// empty.
  std::string unit_unread = {};
  /// A record or comment that places the points and is not applied, as in "its record LAStools 2001
  /// holds the matrix of a scanner"; empty where there is none.
  std::string unplaced = {};

  friend bool operator==(const StatedCrs&, const StatedCrs&) = default;
};

/// What is expected of a file with `unplaced`, as the end of a sentence.
inline constexpr std::string_view kExpectedPlaced =
    ", expected points that are placed. Give the file from which it was made, such as PTX, or make "
    "it again with the matrix applied";

}  // namespace clearway
