#include "io/paths/geographic/map_projection.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <string_view>
#include <utility>

#include "clearway/error.hpp"
#include "clearway/trajectory.hpp"
#include "core/geometry/angle.hpp"
#include "io/files/input_error.hpp"
#include "io/scans/map_scale.hpp"
#include "io/scans/scan_crs.hpp"

namespace clearway {
namespace {

/// Keeps the text that PROJ logs, instead of printing it.
void keep_log(void* kept, int, const char* text) { *static_cast<std::string*>(kept) = text; }

/// A system that the caller names in any form that PROJ reads.
ProjObject create_given(PJ_CONTEXT* context, const std::string& text) {
  const bool proj_string = text.find("+proj=") != std::string::npos;
  const bool typed = text.find("+type=crs") != std::string::npos;
  return ProjObject(
      proj_create(context, (proj_string && !typed ? text + " +type=crs" : text).c_str()));
}

}  // namespace

MapProjection::MapProjection(const TrajectoryOptions& options, const std::string& name)
    : context_(start_proj(keep_log, &log_)),
      // Positions are differentiated on WGS 84.
      conversion_{nullptr, kDegree, 6378137, 6.69437999014e-3, 1e-4 * kDegree} {
  if (!context_) throw ResourceError("PROJ cannot be started");
  const bool from_file = options.crs.empty();
  std::string crs = from_file ? options.default_crs : options.crs;
  if (crs.empty()) {
    refuse(name,
           "positions are latitudes and longitudes; expected the projected coordinate reference "
           "system of the environment",
           Remedy::kNameCrs);
  }
  constexpr std::string_view kEllipsoidal = "+ellipsoidal";
  if (crs.ends_with(kEllipsoidal)) crs.resize(crs.size() - kEllipsoidal.size());
  const auto need = [&](bool sound, const std::string& what) {
    if (sound) return;
    if (!from_file) throw UsageError("the CRS " + excerpt(crs) + ": " + what);
    refuse(name, "the environment's coordinate reference system: " + what, Remedy::kNameCrs);
  };
  need(!from_file || !names_files(crs), "names files, which are not opened");
  PJ_CONTEXT* const c = context_.get();
  ProjObject target = from_file ? create_crs(c, crs) : create_given(c, crs);
  need(target != nullptr, "PROJ does not know it (" + log_ + ")");
  if (proj_get_type(target.get()) == PJ_TYPE_BOUND_CRS) {
    target.reset(proj_get_source_crs(c, target.get()));
  }
  name_ = proj_get_name(target.get()) != nullptr ? proj_get_name(target.get()) : crs;
  ProjObject part;
  const PJ* horizontal = target.get();
  if (proj_get_type(target.get()) == PJ_TYPE_COMPOUND_CRS) {
    part.reset(proj_crs_get_sub_crs(c, target.get(), 0));
    horizontal = part.get();
    const ProjObject vertical(proj_crs_get_sub_crs(c, target.get(), 1));
    vertical_unit_ = unit_of_axis(c, vertical.get(), 0);
  } else {
    vertical_unit_ = unit_of_axis(c, horizontal, 2);
  }
  need(proj_get_type(horizontal) == PJ_TYPE_PROJECTED_CRS,
       "expected a projected one, with easting and northing");
  unit_ = unit_of_axis(c, horizontal, 0);
  need(unit_ > 0, "its unit is not known");
  const char* const text = proj_as_wkt(c, horizontal, PJ_WKT2_2019, nullptr);
  auto map = ScanMap::of(text != nullptr ? text : "");
  need(map.has_value(), "its projection is not known");
  map_.emplace(std::move(*map));

  const std::string& datum = options.datum;
  const ProjObject source = create_given(c, datum.empty() ? "EPSG:4979" : datum);
  need(source != nullptr, excerpt(datum) + " is no geographic datum that PROJ knows");
  const std::array<const char*, 2> how{"ALLOW_BALLPARK=NO", nullptr};
  const ProjObject found(
      proj_create_crs_to_crs_from_pj(c, source.get(), target.get(), nullptr, how.data()));
  if (found) conversion_.operation.reset(proj_normalize_for_visualization(c, found.get()));
  need(conversion_.operation != nullptr,
       "PROJ has no transformation to it from " + (datum.empty() ? "WGS 84" : excerpt(datum)) +
           " without grids that are not installed; expected another CRS, or one without a vertical "
           "part");
}

std::optional<MapProjection::Place> MapProjection::place(double longitude, double latitude,
                                                         double height) const {
  const PJ_COORD at =
      proj_trans(conversion_.operation.get(), PJ_FWD, proj_coord(longitude, latitude, height, 0));
  const auto& [x, y, z] = at.xyz;  // HUGE_VAL for an error
  if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(z)) return std::nullopt;
  const auto north = conversion_.slope(longitude, latitude, height, true);
  const auto scale = map_->at(x, y);
  if (!scale || !north || (north->x == 0 && north->y == 0)) return std::nullopt;
  // A height that was not converted is in metres.
  const double vertical = vertical_unit_ > 0 ? vertical_unit_ : 1;
  return Place{{x, y, z * vertical / unit_}, std::atan2(north->x, north->y), *scale};
}

double MapProjection::skew(double longitude, double latitude, double height) const {
  const auto north = conversion_.slope(longitude, latitude, height, true);
  const auto east = conversion_.slope(longitude, latitude, height, false);
  if (!north || !east) return 0;
  const double turn = std::atan2(north->x, north->y) - std::atan2(-east->y, east->x);
  return std::abs(std::remainder(turn, 2 * std::numbers::pi));
}

double MapProjection::accuracy() const {
  const ProjObject used(proj_trans_get_last_used_operation(conversion_.operation.get()));
  return used ? proj_coordoperation_get_accuracy(context_.get(), used.get()) : -1;
}

}  // namespace clearway
