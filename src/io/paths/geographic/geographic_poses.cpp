#include "io/paths/geographic/geographic_poses.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/angle.hpp"
#include "core/util/format.hpp"
#include "io/paths/geographic/map_projection.hpp"
#include "io/scans/formatted_message.hpp"
#include "io/scans/length_unit.hpp"
#include "io/scans/map_scale.hpp"

namespace clearway {
namespace {

struct Range {
  double least = std::numeric_limits<double>::infinity(), greatest = -least;

  void add(double value) {
    least = std::min(least, value);
    greatest = std::max(greatest, value);
  }
  std::string text(double unit = 1) const {
    const std::string from = format_digits(least / unit, 6), to = format_digits(greatest / unit, 6);
    return from == to ? from : from + " to " + to;
  }
};

/// Ranges of the map's properties at the poses of a file.
struct Ranges {
  Range north, scale, height;
  MapScale worst{};  ///< the scale that is farthest from 1

  void add(const MapProjection::Place& place) {
    north.add(place.north);
    scale.add(place.scale.farthest);
    height.add(place.position.z);
    if (place.scale.error() > worst.error()) worst = place.scale;
  }
};

/// Checks that the map turns all directions at a pose alike, because its rotation uses a single
/// angle.
void check_shape(const MapProjection& map, const AttitudeRow& row, const std::string& name,
                 TrajectoryFile& out) {
  const double skew = map.skew(row.position[0], row.position[1], row.position[2]);
  constexpr double kMirrored = 1;
  constexpr double kConformal = 1e-3;
  if (skew > kMirrored) {
    refuse(name, map.name() + " has axes that mirror the map; expected easting and northing",
           Remedy::kNameCrs);
  }
  if (skew > kConformal) {
    out.warn("map-distorts", {{"degrees", skew / kDegree}},
             "{}: {} distorts angles by {} degrees; a rigid model does not fit such a map", name,
             map.name(), format_digits(skew / kDegree, 9));
  }
}

void remark_heights(const MapProjection& map, const TrajectoryOptions& options,
                    const Ranges& ranges, const std::string& name, TrajectoryFile& out) {
  if (map.converts_heights()) {
    out.note("heights-converted",
             name + ": heights are those of " + map.name() + ", from " + ranges.height.text());
    return;
  }
  if (options.crs.ends_with("+ellipsoidal")) return;
  out.warn("ellipsoidal-heights",
           name + ": heights are ellipsoidal, as in the file, from " + ranges.height.text() +
               ". Heights above sea level differ by up to 107 m. Give a CRS with a vertical part, "
               "or add +ellipsoidal to it where the scan has such heights too",
           {{"least", ranges.height.least}, {"greatest", ranges.height.greatest}});
}

void remark_map(const MapProjection& map, const TrajectoryOptions& options, const Ranges& ranges,
                const std::string& name, TrajectoryFile& out) {
  constexpr double kFeet = 0.9;
  out.note("map-projection",
           name + ": positions are in " + map.name() +
               (options.crs.empty() ? ", as the environment" : "") + "; true north lies " +
               ranges.north.text(kDegree) + " degrees clockwise from its northing; its scale, " +
               ranges.scale.text() + ", is not applied to the model",
           {{"least_scale", ranges.scale.least}, {"greatest_scale", ranges.scale.greatest}});
  const double unit = map.metres_per_unit(), environment = options.environment_unit;
  if (environment != 1 && std::abs(unit - environment) > 1e-9) {
    out.warn("map-unit", {{"metres", unit}},
             "{}: positions are in the unit of {}, {} m, but the environment is in {}. Give the "
             "CRS of the environment",
             name, map.name(), format_digits(unit, 9), units_text(environment));
  } else if (unit < kFeet) {
    out.note("map-unit", {{"metres", unit}},
             "{}: the unit of {} is {} m; model, radius and lever arm are to be in it too", name,
             map.name(), format_digits(unit, 9));
  }
  const MapScale& worst = ranges.worst;
  if (worst.error() > kMapScaleWarning) {
    out.warn(
        "map-scale",
        {{"error", worst.error()}, {"scale", worst.farthest}, {"mean_scale", worst.mean}},
        "{}: lengths on the map of {} are wrong by {} % at longitude {}, latitude {}: they are {} "
        "times those on the ground ({} times by area). Another zone or another CRS may be meant",
        name, map.name(), format_digits(100 * worst.error(), 9), format_brief(worst.longitude),
        format_brief(worst.latitude), format_brief(worst.farthest), format_brief(worst.mean));
  }
}

void remark_datum(const MapProjection& map, const TrajectoryOptions& options,
                  const std::string& name, TrajectoryFile& out) {
  const double accuracy = map.accuracy();
  constexpr double kExpected = 1;  // metres, between WGS 84 and similar datums
  if (accuracy == 0) return;
  const std::string datum = options.datum.empty() ? "WGS 84" : options.datum;
  const std::string text = name + ": positions were taken as " + datum + ", and the datum of " +
                           map.name() + " is reached with an accuracy of " +
                           (accuracy > 0 ? format_digits(accuracy, 9) + " m" : "unknown size") +
                           "; name the datum of the file where it is another";
  const bool is_expected = accuracy > 0 && accuracy <= kExpected;
  out.warn_or_note(!is_expected, "datum-accuracy", text, {{"metres", accuracy}});
}

}  // namespace

void append_geographic_poses(std::span<const AttitudeRow> rows, AngleFrame frame,
                             const TrajectoryOptions& options, const std::string& name,
                             TrajectoryFile& out) {
  if (rows.empty()) return;
  const MapProjection map(options, name);
  check_shape(map, rows[0], name, out);
  Ranges ranges;
  out.poses.reserve(out.poses.size() + rows.size());
  for (const AttitudeRow& row : rows) {
    const auto place = map.place(row.position[0], row.position[1], row.position[2]);
    if (!place) {
      refuse(name, Remedy::kNameCrs,
             "pose {}: {} does not reach latitude {}, longitude {}; expected a CRS of this place",
             out.poses.size(), map.name(), format_digits(row.position[1], 9),
             format_digits(row.position[0], 9));
    }
    Pose pose{{}, {place->position.x, place->position.y, place->position.z}};
    set_rotation(row, frame, place->north, pose);
    out.poses.push_back(pose);
    ranges.add(*place);
  }
  out.crs = map.name();
  out.metres_per_unit = map.metres_per_unit();
  remark_map(map, options, ranges, name, out);
  remark_heights(map, options, ranges, name, out);
  remark_datum(map, options, name, out);
}

}  // namespace clearway
