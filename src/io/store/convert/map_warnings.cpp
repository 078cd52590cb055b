#include "io/store/convert/map_warnings.hpp"

#include <algorithm>
#include <cmath>

#include "core/util/format.hpp"
#include "io/files/input_error.hpp"
#include "io/scans/map_scale.hpp"

namespace clearway {

void check_map_scale(const CommonCrs& crs, const Box& box, const std::filesystem::path& source,
                     bool ignore, MessageLog& log) {
  const std::optional<ScanMap> map = ScanMap::of(crs.crs);
  if (!map) return;
  // Coordinates may be in another unit than that of the map, where keys of a file say so.
  const double metres = metres_of(crs.unit);
  const double unit = metres > 0 ? metres / map->metres_per_unit() : 1;
  const std::optional<MapScale> scale =
      map->at((box.lo.x / 2 + box.hi.x / 2) * unit, (box.lo.y / 2 + box.hi.y / 2) * unit);
  if (!scale) {
    log.warn("map-scale-unknown",
             "how long the map of " + map->name() +
                 " shows lengths at the middle of the scan cannot be computed, so distances may be "
                 "wrong. Are the coordinates those of this system?");
    return;
  }
  if (scale->error() <= kMapScaleWarning) return;
  const std::string text =
      "lengths on the map of " + map->name() + " are " + format_brief(scale->farthest) +
      " times those on the ground at the middle of the scan (" + format_brief(scale->mean) +
      " times by area; longitude " + format_brief(scale->longitude) + ", latitude " +
      format_brief(scale->latitude) + ")";
  if (scale->error() > kMostMapScale && !ignore) {
    refuse(source.string(),
           text +
               ", expected a map that keeps lengths within 5 %; transform the scan to a system "
               "of its place, such as its UTM zone",
           Remedy::kIgnoreCrs);
  }
  log.warn(kMapScaleCode,
           text +
               ", so distances, radius and model are wrong by this factor; transform the scan to "
               "a system of its place",
           {{"scale", scale->farthest},
            {"mean_scale", scale->mean},
            {"longitude", scale->longitude},
            {"latitude", scale->latitude}});
}

void warn_of_degrees(const Box& box, MessageLog& log) {
  constexpr double kMostDegrees = 360;
  // A degree is 111 km and heights are in metres, so a scan in degrees is a thin column: its height
  // is at least this many times its length. A mast of 50 m would have to be thinner than a metre.
  constexpr double kColumn = 50;
  const Vec3 size{box.hi.x - box.lo.x, box.hi.y - box.lo.y, box.hi.z - box.lo.z};
  const double length = std::max(size.x, size.y);
  const double farthest =
      std::max({std::abs(box.lo.x), std::abs(box.hi.x), std::abs(box.lo.y), std::abs(box.hi.y)});
  if (!(length > 0) || size.z < kColumn * length || farthest > kMostDegrees) return;
  log.warn("degrees",
           "the coordinates look like longitudes and latitudes: they span " + format_brief(size.x) +
               " by " + format_brief(size.y) + ", and heights span " + format_brief(size.z) +
               ". They are taken for lengths; if they are angles, project the scan first",
           {{"x", size.x}, {"y", size.y}, {"z", size.z}});
}

}  // namespace clearway
