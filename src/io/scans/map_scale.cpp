#include "io/scans/map_scale.hpp"

#include <cmath>

namespace clearway {

double MapScale::error() const { return std::abs(farthest - 1); }

std::optional<Vec3> MapConversion::slope(double longitude, double latitude, double height,
                                         bool to_north) const {
  const double sine = std::sin(latitude * angle);
  const double w2 = 1 - eccentricity2 * sine * sine;
  double metres = 2 * step * semi_major / std::sqrt(w2);
  metres *= to_north ? (1 - eccentricity2) / w2 : std::cos(latitude * angle);
  const double east = to_north ? 0 : step / angle, north = to_north ? step / angle : 0;
  const auto at = [&](double sign) {
    return proj_trans(operation.get(), PJ_FWD,
                      proj_coord(longitude + sign * east, latitude + sign * north, height, 0));
  };
  const PJ_COORD ahead = at(1), behind = at(-1);
  const Vec3 out{(ahead.xy.x - behind.xy.x) / metres, (ahead.xy.y - behind.xy.y) / metres, 0};
  if (!std::isfinite(out.x) || !std::isfinite(out.y)) return std::nullopt;
  return out;
}

namespace {

/// The conversion from the geographic system `base` to the map `crs` that stands on it.
MapConversion conversion_of(PJ_CONTEXT* c, const PJ* base, const PJ* crs) {
  MapConversion out;
  const ProjObject ellipsoid(proj_get_ellipsoid(c, base));
  double inverse_flattening = 0;
  if (!ellipsoid || proj_ellipsoid_get_parameters(c, ellipsoid.get(), &out.semi_major, nullptr,
                                                  nullptr, &inverse_flattening) == 0) {
    return out;
  }
  const double flattening = inverse_flattening > 0 ? 1 / inverse_flattening : 0;
  out.eccentricity2 = flattening * (2 - flattening);
  out.angle = unit_of_axis(c, base, 0);
  const char* const text = proj_as_wkt(c, crs, PJ_WKT2_2019, nullptr);
  if (!(out.angle > 0) || text == nullptr || names_files(text)) return out;
  const ProjObject found(proj_create_crs_to_crs_from_pj(c, base, crs, nullptr, nullptr));
  if (found) out.operation.reset(proj_normalize_for_visualization(c, found.get()));
  return out;
}

}  // namespace

std::optional<ScanMap> ScanMap::of(const std::string& text) {
  ScanMap map;
  map.context_ = start_proj();
  PJ_CONTEXT* const c = map.context_.get();
  const ProjObject crs = c != nullptr ? plane_of(c, create_crs(c, text)) : nullptr;
  if (!crs) return std::nullopt;
  // A derived map stands on a projected system, and this on a geographic one.
  ProjObject base;
  bool is_map = false;
  for (const PJ* at = crs.get(); at != nullptr && !is_map; at = base.get()) {
    is_map = proj_get_type(at) == PJ_TYPE_PROJECTED_CRS;
    base.reset(proj_get_source_crs(c, at));
  }
  if (!is_map) return std::nullopt;
  if (base) map.conversion_ = conversion_of(c, base.get(), crs.get());
  if (const char* name = proj_get_name(crs.get())) map.name_ = name;
  map.unit_ = unit_of_axis(c, crs.get(), 0);
  return map;
}

std::optional<MapScale> ScanMap::at(double easting, double northing) const {
  PJ* const operation = conversion_.operation.get();
  if (operation == nullptr) return std::nullopt;
  const PJ_COORD place = proj_trans(operation, PJ_INV, proj_coord(easting, northing, 0, 0));
  const double longitude = place.v[0], latitude = place.v[1];
  if (!std::isfinite(longitude) || !std::isfinite(latitude)) return std::nullopt;
  // Far outside of its place the inverse of some projections is any place.
  constexpr double kReturns = 1;  // metres
  const PJ_COORD back = proj_trans(operation, PJ_FWD, place);
  if (!(std::hypot(back.xy.x - easting, back.xy.y - northing) * unit_ < kReturns)) {
    return std::nullopt;
  }
  const auto east = conversion_.slope(longitude, latitude, 0, false);
  const auto north = conversion_.slope(longitude, latitude, 0, true);
  if (!east || !north) return std::nullopt;
  // The axes of Tissot's ellipse are the singular values of the matrix of both vectors.
  const double sum = std::hypot(east->x + north->y, east->y - north->x);
  const double difference = std::hypot(east->x - north->y, east->y + north->x);
  const double greatest = (sum + difference) / 2 * unit_;
  const double least = std::abs(sum - difference) / 2 * unit_;
  MapScale scale;
  scale.farthest = std::abs(greatest - 1) >= std::abs(least - 1) ? greatest : least;
  scale.mean = std::sqrt(greatest * least);
  scale.longitude = longitude * conversion_.angle / kDegree;
  scale.latitude = latitude * conversion_.angle / kDegree;
  if (!(least > 0) || !std::isfinite(greatest)) return std::nullopt;
  return scale;
}

}  // namespace clearway
