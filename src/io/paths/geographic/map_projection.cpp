#include "io/paths/geographic/map_projection.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <string_view>

#include "clearway/error.hpp"
#include "clearway/trajectory.hpp"
#include "core/geometry/angle.hpp"
#include "io/files/input_error.hpp"
#include "io/scans/map_scale.hpp"
#include "io/scans/scan_crs.hpp"

namespace clearway {
namespace {

constexpr double kSemiMajor = 6378137;               // semi-major axis of WGS 84, metres
constexpr double kEccentricity2 = 6.69437999014e-3;  // squared eccentricity of WGS 84

/// Keeps the text that PROJ logs, instead of printing it.
void keep_log(void* kept, int, const char* text) { *static_cast<std::string*>(kept) = text; }

}  // namespace

struct MapProjection::Parts {
  std::string log;  ///< must outlive the context
  ProjContext context;
  ProjObject transformation;
  std::optional<ScanMap> map;

  ProjObject create(const std::string& text, bool from_file) {
    if (from_file) return create_crs(context.get(), text);
    const bool proj_string = text.find("+proj=") != std::string::npos;
    const bool typed = text.find("+type=crs") != std::string::npos;
    return ProjObject(
        proj_create(context.get(), (proj_string && !typed ? text + " +type=crs" : text).c_str()));
  }
};

MapProjection::~MapProjection() = default;
MapProjection::MapProjection(MapProjection&&) noexcept = default;
MapProjection& MapProjection::operator=(MapProjection&&) noexcept = default;

MapProjection::MapProjection(const TrajectoryOptions& options) : parts_(std::make_unique<Parts>()) {
  parts_->context = start_proj(keep_log, &parts_->log);
  if (!parts_->context) throw ResourceError("PROJ cannot be started");
  const bool from_file = options.crs.empty();
  std::string crs = from_file ? options.default_crs : options.crs;
  constexpr std::string_view kEllipsoidal = "+ellipsoidal";
  if (crs.ends_with(kEllipsoidal)) crs.resize(crs.size() - kEllipsoidal.size());
  const auto refuse_crs = [&](const std::string& what) {
    if (!from_file) throw UsageError("the CRS " + excerpt(crs) + ": " + what);
    throw InputError("the environment's coordinate reference system: " + what, Remedy::kNameCrs);
  };
  if (from_file && names_files(crs)) refuse_crs("names files, which are not opened");
  try {
    open(crs, from_file, options.datum);
  } catch (const Error& error) {
    refuse_crs(error.what());
  }
}

void MapProjection::open(const std::string& crs, bool from_file, const std::string& datum) {
  PJ_CONTEXT* context = parts_->context.get();
  ProjObject target = parts_->create(crs, from_file);
  if (!target) throw InputError("PROJ does not know it (" + parts_->log + ")");
  if (proj_get_type(target.get()) == PJ_TYPE_BOUND_CRS) {
    target.reset(proj_get_source_crs(context, target.get()));
  }
  name_ = proj_get_name(target.get()) != nullptr ? proj_get_name(target.get()) : crs;
  ProjObject part;
  const PJ* horizontal = target.get();
  if (proj_get_type(target.get()) == PJ_TYPE_COMPOUND_CRS) {
    part.reset(proj_crs_get_sub_crs(context, target.get(), 0));
    horizontal = part.get();
    const ProjObject vertical(proj_crs_get_sub_crs(context, target.get(), 1));
    vertical_unit_ = unit_of_axis(context, vertical.get(), 0);
  } else {
    vertical_unit_ = unit_of_axis(context, horizontal, 2);
  }
  if (proj_get_type(horizontal) != PJ_TYPE_PROJECTED_CRS) {
    throw InputError("expected a projected one, with easting and northing");
  }
  unit_ = unit_of_axis(context, horizontal, 0);
  if (!(unit_ > 0)) throw InputError("its unit is not known");
  const char* const text = proj_as_wkt(context, horizontal, PJ_WKT2_2019, nullptr);
  parts_->map = ScanMap::of(text != nullptr ? text : "");
  if (!parts_->map) throw InputError("its projection is not known");

  const ProjObject source = parts_->create(datum.empty() ? "EPSG:4979" : datum, false);
  if (!source) throw UsageError(excerpt(datum) + " is no geographic datum that PROJ knows");
  const std::array<const char*, 2> options{"ALLOW_BALLPARK=NO", nullptr};
  const ProjObject found(
      proj_create_crs_to_crs_from_pj(context, source.get(), target.get(), nullptr, options.data()));
  if (found) parts_->transformation.reset(proj_normalize_for_visualization(context, found.get()));
  if (!parts_->transformation) {
    throw InputError("PROJ has no transformation to it from " +
                     (datum.empty() ? "WGS 84" : excerpt(datum)) +
                     " without grids that are not installed; expected another CRS, or one without "
                     "a vertical part");
  }
}

bool MapProjection::project(double longitude, double latitude, double height,
                            double (&xyz)[3]) const {
  const PJ_COORD place =
      proj_trans(parts_->transformation.get(), PJ_FWD, proj_coord(longitude, latitude, height, 0));
  for (int k = 0; k < 3; ++k) {
    xyz[k] = place.v[k];
    if (!std::isfinite(xyz[k])) return false;  // PROJ returns HUGE_VAL for an error
  }
  return true;
}

/// The vector on the map, in its unit, of a metre to true north or east; zeros outside the map.
Vec3 MapProjection::slope(double longitude, double latitude, double height,
                          bool along_north) const {
  constexpr double kStep = 1e-4;  // degrees; 11 m, over which a map bends by less than 1e-10
  const double sine = std::sin(latitude * kDegree);
  const double w2 = 1 - kEccentricity2 * sine * sine;
  double metres = 2 * kStep * kDegree * kSemiMajor / std::sqrt(w2);
  metres *= along_north ? (1 - kEccentricity2) / w2 : std::cos(latitude * kDegree);
  const double east = along_north ? 0 : kStep;
  const double north = along_north ? kStep : 0;
  double ahead[3];
  double behind[3];
  if (!project(longitude + east, latitude + north, height, ahead) ||
      !project(longitude - east, latitude - north, height, behind)) {
    return {};
  }
  return {(ahead[0] - behind[0]) / metres, (ahead[1] - behind[1]) / metres, 0};
}

std::optional<MapProjection::Place> MapProjection::place(double longitude, double latitude,
                                                         double height) const {
  double xyz[3];
  if (!project(longitude, latitude, height, xyz)) return std::nullopt;
  const Vec3 north = slope(longitude, latitude, height, true);
  const auto scale = parts_->map->at(xyz[0], xyz[1]);
  if (!scale || (north.x == 0 && north.y == 0)) return std::nullopt;
  // A height that was not converted.
  const double vertical = vertical_unit_ > 0 ? vertical_unit_ : 1;
  return Place{{xyz[0], xyz[1], xyz[2] * vertical / unit_}, std::atan2(north.x, north.y), *scale};
}

double MapProjection::skew(double longitude, double latitude, double height) const {
  const Vec3 north = slope(longitude, latitude, height, true);
  const Vec3 east = slope(longitude, latitude, height, false);
  const double turn = std::atan2(north.x, north.y) - std::atan2(-east.y, east.x);
  return std::abs(std::remainder(turn, 2 * std::numbers::pi));
}

double MapProjection::accuracy() const {
  const ProjObject used(proj_trans_get_last_used_operation(parts_->transformation.get()));
  if (!used) return -1;
  return proj_coordoperation_get_accuracy(parts_->context.get(), used.get());
}

}  // namespace clearway
