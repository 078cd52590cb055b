#pragma once

#include <memory>
#include <optional>
#include <string>

#include "clearway/vec3.hpp"

namespace clearway {

struct TrajectoryOptions;

/// Turns latitudes, longitudes and ellipsoidal heights into the coordinates of a projected
/// coordinate reference system. By PROJ, without its network, and never by a transformation that
/// would need a grid that is not installed.
class MapProjection {
 public:
  struct Place {
    Vec3 position;  ///< easting, northing, height in the unit of the CRS
    double north;   ///< where true north lies, clockwise from the direction of northing, radians
    double scale;   ///< length on the map divided by the length on the ellipsoid
  };

  /// To options.crs, or else to options.default_crs. Throws UsageError for a CRS given by the
  /// caller that cannot be used, InputError for one that cannot be used and came from a file.
  explicit MapProjection(const TrajectoryOptions& options);
  ~MapProjection();
  MapProjection(MapProjection&&) noexcept;
  MapProjection& operator=(MapProjection&&) noexcept;

  /// Degrees and metres. None where the CRS does not reach.
  std::optional<Place> place(double longitude, double latitude, double height) const;

  /// How far the map is from turning all directions at a place by the same angle, radians: 0 for a
  /// conformal map, pi for one that mirrors.
  double skew(double longitude, double latitude, double height) const;

  const std::string& name() const { return name_; }
  double metres_per_unit() const { return unit_; }
  /// The CRS has a vertical part, which heights are turned into.
  bool converts_heights() const { return vertical_unit_ > 0; }
  /// Of the change of datum at the place last asked for, metres, as PROJ's database has it; 0 for
  /// none, negative where it is not known.
  double accuracy() const;

 private:
  struct Parts;
  void open(const std::string& crs, bool from_file, const std::string& datum);
  bool project(double longitude, double latitude, double height, double (&xyz)[3]) const;
  Vec3 slope(double longitude, double latitude, double height, bool along_north) const;

  std::unique_ptr<Parts> parts_;
  std::string name_;
  double unit_ = 1;           ///< metres, of easting and northing
  double vertical_unit_ = 0;  ///< metres, of heights; 0: the CRS has none
};

}  // namespace clearway
