#include "io/store/convert/map_warnings.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "core/util/format.hpp"
#include "io/scans/formatted_message.hpp"
#include "io/scans/map_scale.hpp"

namespace clearway {

namespace {

/// The files of one coordinate reference system.
struct FilesOfSystem {
  std::string crs;    ///< as scan_crs_of() reads it
  LengthUnit unit;    ///< of their coordinates
  std::string first;  ///< the name of the first one
  std::vector<FileBox> boxes;
};

/// The files by their systems, in the order of the first file of each. Files whose system is not
/// read are left out.
std::vector<FilesOfSystem> by_system(const EnvironmentSource& environment,
                                     std::span<const FileBox> boxes) {
  const CommonCrs& common = environment.crs();
  std::vector<FilesOfSystem> out;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const CloudInfo& info = environment.infos()[i];
    const bool is_unnamed = info.crs.empty() && info.crs_wkt.empty();
    const std::string& crs = is_unnamed ? common.crs : info.crs;
    if (crs.empty()) continue;
    const LengthUnit unit = info.unit != LengthUnit::kUnknown ? info.unit : common.unit;
    auto same = std::ranges::find_if(
        out, [&](const FilesOfSystem& one) { return one.crs == crs && one.unit == unit; });
    if (same == out.end()) {
      out.push_back({crs, unit, environment.files()[i].string(), {}});
      same = out.end() - 1;
    }
    same->boxes.push_back(boxes[i]);
  }
  return out;
}

/// Judges the map of one system. name: what a warning begins with.
void check_map_scale(const FilesOfSystem& files, const Box& box, const std::string& name,
                     bool ignore, MessageLog& log) {
  const std::optional<ScanMap> map = ScanMap::of(files.crs);
  if (!map) return;
  // Coordinates may be in another unit than that of the map, where keys of a file say so.
  const double metres = metres_of(files.unit);
  const double unit = metres > 0 ? metres / map->metres_per_unit() : 1;
  const std::optional<MapScale> scale =
      map->at((box.lo.x / 2 + box.hi.x / 2) * unit, (box.lo.y / 2 + box.hi.y / 2) * unit);
  if (!scale) {
    log.warn("map-scale-unknown",
             name + "how long the map of " + map->name() +
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
    refuse(files.first, Remedy::kIgnoreCrs,
           "{}, expected a map that keeps lengths within 5 %; transform the scan to a system of "
           "its place, such as its UTM zone",
           text);
  }
  log.warn(kMapScaleCode,
           name + text +
               ", so distances, radius and model are wrong by this factor; transform the scan to "
               "a system of its place",
           {{"scale", scale->farthest},
            {"mean_scale", scale->mean},
            {"longitude", scale->longitude},
            {"latitude", scale->latitude}});
}

}  // namespace

void check_map_scales(const EnvironmentSource& environment, std::span<const FileBox> boxes,
                      bool ignore, MessageLog& log) {
  const std::vector<FilesOfSystem> systems = by_system(environment, boxes);
  for (const FilesOfSystem& files : systems) {
    const std::optional<Box> box = common_box(files.boxes, environment.quantisation());
    if (!box) continue;
    check_map_scale(files, *box, systems.size() > 1 ? files.first + ": " : "", ignore, log);
  }
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
  log.warn("like-degrees",
           "the coordinates look like longitudes and latitudes: they span " + format_brief(size.x) +
               " by " + format_brief(size.y) + ", and heights span " + format_brief(size.z) +
               ". They are taken for lengths; if they are angles, project the scan first",
           {{"x", size.x}, {"y", size.y}, {"z", size.z}});
}

}  // namespace clearway
