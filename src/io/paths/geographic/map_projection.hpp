#pragma once

#include <optional>
#include <string>

#include "clearway/vec3.hpp"
#include "io/scans/map_scale.hpp"

namespace clearway {

struct TrajectoryOptions;

/// Converts latitudes, longitudes and ellipsoidal heights into the coordinates of a projected
/// coordinate reference system. Uses PROJ without its network, and never a transformation that
/// would need a grid that is not installed.
class MapProjection {
 public:
  struct Place {
    Vec3 position;   ///< easting, northing, height in the unit of the CRS
    double north;    ///< direction of true north, clockwise from the direction of northing, radians
    MapScale scale;  ///< scale of the map at the position
  };

  /// Projects to options.crs, or else to options.default_crs. name: the trajectory's file, for
  /// messages. Throws UsageError for an unusable CRS given by the caller, InputError for one that
  /// came from a file and where there is none.
  MapProjection(const TrajectoryOptions& options, const std::string& name);
  MapProjection(const MapProjection&) = delete;
  MapProjection& operator=(const MapProjection&) = delete;

  /// The place on the map of a position in degrees and metres; nullopt where the CRS does not
  /// reach.
  std::optional<Place> place(double longitude, double latitude, double height) const;

  /// Deviation in radians from turning all directions at a place by the same angle: 0 for a
  /// conformal map, pi for one that mirrors.
  double skew(double longitude, double latitude, double height) const;

  const std::string& name() const { return name_; }
  double metres_per_unit() const { return unit_; }
  /// Whether the CRS has a vertical part, into which heights are converted.
  bool converts_heights() const { return vertical_unit_ > 0; }
  /// Accuracy in metres of the change of datum at the last requested place, according to PROJ's
  /// database; 0 where the datum does not change, negative where it is not known.
  double accuracy() const;

 private:
  std::string log_;  ///< what PROJ says last; must outlive the context
  ProjContext context_;
  MapConversion conversion_;
  std::optional<ScanMap> map_;
  std::string name_;
  double unit_ = 1;           ///< unit of easting and northing, metres
  double vertical_unit_ = 0;  ///< unit of heights, metres; 0 where the CRS has no heights
};

}  // namespace clearway
