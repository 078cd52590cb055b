#pragma once

#include <optional>
#include <string>

#include "clearway/vec3.hpp"
#include "core/geometry/angle.hpp"
#include "io/scans/scan_crs.hpp"

namespace clearway {

/// How a map changes lengths at a place.
struct MapScale {
  /// Length on the map divided by the length on the ellipsoid, in the direction of the axis of
  /// Tissot's ellipse that is farther from 1.
  double farthest = 1;
  double mean = 1;  ///< root of the area on the map divided by the area on the ellipsoid
  double longitude = 0, latitude = 0;  ///< degrees, in the geographic system of the map

  /// The error of lengths as a share: 0.494 where the map shows 1.494 m for a metre.
  double error() const;
};

/// Error of lengths above which a map causes a warning. A UTM zone has 0.001 within its borders.
inline constexpr double kMapScaleWarning = 2e-3;
/// Error of lengths above which a map is refused as a scan's system.
inline constexpr double kMostMapScale = 0.05;

/// A conversion by PROJ from longitudes and latitudes to a map, with its derivatives.
struct MapConversion {
  ProjObject operation;                      ///< null where PROJ has none
  double angle = kDegree;                    ///< radians per unit of longitudes and latitudes
  double semi_major = 0, eccentricity2 = 0;  ///< of the ellipsoid
  /// Radians to either side of a place over which the map is differentiated: some 10 m, over which
  /// a map bends by less than 1e-10.
  double step = 1e-6;

  /// The vector on the map, in its unit, of a metre on the ellipsoid to true north, or else to the
  /// east. Nullopt outside of the map.
  std::optional<Vec3> slope(double longitude, double latitude, double height, bool to_north) const;
};

/// A projected coordinate reference system, which shows the ellipsoid on a plane.
class ScanMap {
 public:
  /// The map of a system in a form that scan_crs_of() reads. Nullopt where the text is no map:
  /// geographic, geocentric and local systems, and texts that PROJ does not read.
  static std::optional<ScanMap> of(const std::string& crs);
  ScanMap(ScanMap&&) = default;

  /// The scale at a place. easting, northing: in the unit of the map. Nullopt where it is not
  /// known: the map does not reach the place, or PROJ cannot compute its projection.
  std::optional<MapScale> at(double easting, double northing) const;

  const std::string& name() const { return name_; }
  double metres_per_unit() const { return unit_; }

 private:
  ScanMap() = default;

  ProjContext context_;
  MapConversion conversion_;  ///< has no operation where PROJ would have to open a file for it
  std::string name_;
  double unit_ = 1;
};

}  // namespace clearway
