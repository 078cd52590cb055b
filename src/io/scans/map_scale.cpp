#include "io/scans/map_scale.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "clearway/vec3.hpp"
#include "core/geometry/angle.hpp"
#include "io/scans/scan_crs.hpp"

namespace clearway {

double MapScale::error() const { return std::abs(farthest - 1); }

struct ScanMap::Parts {
  ProjContext context;
  ProjObject crs;
  /// From longitudes and latitudes in units of `angle` radians to the map; null where PROJ has no
  /// such operation or would have to open a file for it.
  ProjObject projection;
  double angle = kDegree;
  double semi_major = 0, eccentricity2 = 0;

  void open(const PJ* base);
  std::optional<Vec3> slope(double longitude, double latitude, double east, double north) const;
};

void ScanMap::Parts::open(const PJ* base) {
  PJ_CONTEXT* const c = context.get();
  const ProjObject ellipsoid(proj_get_ellipsoid(c, base));
  double inverse_flattening = 0;
  if (!ellipsoid || proj_ellipsoid_get_parameters(c, ellipsoid.get(), &semi_major, nullptr, nullptr,
                                                  &inverse_flattening) == 0) {
    return;
  }
  const double flattening = inverse_flattening > 0 ? 1 / inverse_flattening : 0;
  eccentricity2 = flattening * (2 - flattening);
  angle = unit_of_axis(c, base, 0);
  const char* const text = proj_as_wkt(c, crs.get(), PJ_WKT2_2019, nullptr);
  if (!(angle > 0) || text == nullptr || names_files(text)) return;
  const ProjObject found(proj_create_crs_to_crs_from_pj(c, base, crs.get(), nullptr, nullptr));
  if (found) projection.reset(proj_normalize_for_visualization(c, found.get()));
}

/// The vector on the map, in its unit, of a metre on the ellipsoid. east, north: which of the two
/// directions it has, 1 for one and 0 for the other. Nullopt outside of the map.
std::optional<Vec3> ScanMap::Parts::slope(double longitude, double latitude, double east,
                                          double north) const {
  constexpr double kStep = 1e-6;  // radians; 6 m, over which a map bends by less than 1e-10
  const double sine = std::sin(latitude * angle);
  const double w2 = 1 - eccentricity2 * sine * sine;
  double metres = 2 * kStep * semi_major / std::sqrt(w2);
  metres *= east > 0 ? std::cos(latitude * angle) : (1 - eccentricity2) / w2;
  const double step = kStep / angle;
  const auto at = [&](double sign) {
    return proj_trans(
        projection.get(), PJ_FWD,
        proj_coord(longitude + sign * step * east, latitude + sign * step * north, 0, 0));
  };
  const PJ_COORD ahead = at(1), behind = at(-1);
  const Vec3 out{(ahead.xy.x - behind.xy.x) / metres, (ahead.xy.y - behind.xy.y) / metres, 0};
  if (!std::isfinite(out.x) || !std::isfinite(out.y)) return std::nullopt;
  return out;
}

ScanMap::ScanMap(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {
  if (const char* name = proj_get_name(parts_->crs.get())) name_ = name;
  unit_ = unit_of_axis(parts_->context.get(), parts_->crs.get(), 0);
}

ScanMap::~ScanMap() = default;
ScanMap::ScanMap(ScanMap&&) noexcept = default;
ScanMap& ScanMap::operator=(ScanMap&&) noexcept = default;

std::optional<ScanMap> ScanMap::of(const std::string& crs) {
  auto parts = std::make_unique<Parts>();
  parts->context = start_proj();
  if (!parts->context) return std::nullopt;
  PJ_CONTEXT* const c = parts->context.get();
  parts->crs = plane_of(c, create_crs(c, crs));
  if (!parts->crs) return std::nullopt;
  // A derived map stands on a projected system, and this on a geographic one.
  ProjObject base;
  bool is_map = false;
  for (const PJ* at = parts->crs.get(); at != nullptr && !is_map; at = base.get()) {
    is_map = proj_get_type(at) == PJ_TYPE_PROJECTED_CRS;
    base.reset(proj_get_source_crs(c, at));
  }
  if (!is_map) return std::nullopt;
  if (base) parts->open(base.get());
  return ScanMap(std::move(parts));
}

std::optional<MapScale> ScanMap::at(double easting, double northing) const {
  if (!parts_->projection) return std::nullopt;
  const PJ_COORD place =
      proj_trans(parts_->projection.get(), PJ_INV, proj_coord(easting, northing, 0, 0));
  const double longitude = place.v[0], latitude = place.v[1];
  if (!std::isfinite(longitude) || !std::isfinite(latitude)) return std::nullopt;
  // Far outside of its place the inverse of some projections is any place.
  constexpr double kReturns = 1;  // metres
  const PJ_COORD back = proj_trans(parts_->projection.get(), PJ_FWD, place);
  if (!(std::hypot(back.xy.x - easting, back.xy.y - northing) * unit_ < kReturns)) {
    return std::nullopt;
  }
  const auto east = parts_->slope(longitude, latitude, 1, 0);
  const auto north = parts_->slope(longitude, latitude, 0, 1);
  if (!east || !north) return std::nullopt;
  // The axes of Tissot's ellipse are the singular values of the matrix of both vectors.
  const double sum = std::hypot(east->x + north->y, east->y - north->x);
  const double difference = std::hypot(east->x - north->y, east->y + north->x);
  const double greatest = (sum + difference) / 2 * unit_;
  const double least = std::abs(sum - difference) / 2 * unit_;
  MapScale scale;
  scale.farthest = std::abs(greatest - 1) >= std::abs(least - 1) ? greatest : least;
  scale.mean = std::sqrt(greatest * least);
  scale.longitude = longitude * parts_->angle / kDegree;
  scale.latitude = latitude * parts_->angle / kDegree;
  if (!(least > 0) || !std::isfinite(greatest)) return std::nullopt;
  return scale;
}

}  // namespace clearway
