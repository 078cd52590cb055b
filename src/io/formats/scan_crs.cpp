#include "io/formats/scan_crs.hpp"

#include <charconv>
#include <string_view>

#include "io/formats/proj_objects.hpp"

namespace clearway {
namespace {

constexpr std::int32_t kGreatestCode = 99'999;  // EPSG codes are not greater

std::int32_t epsg_of(const PJ* crs) {
  const char* authority = proj_get_id_auth_name(crs, 0);
  const char* code = proj_get_id_code(crs, 0);
  if (authority == nullptr || code == nullptr || std::string_view(authority) != "EPSG") return 0;
  const std::string_view text = code;
  std::int32_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool whole = error == std::errc() && end == text.data() + text.size();
  return whole && number > 0 && number <= kGreatestCode ? number : 0;
}

std::int32_t horizontal_epsg_of(PJ_CONTEXT* context, const PJ* crs) {
  if (proj_get_type(crs) != PJ_TYPE_COMPOUND_CRS) return epsg_of(crs);
  const ProjObject horizontal(proj_crs_get_sub_crs(context, crs, 0));
  return horizontal ? epsg_of(horizontal.get()) : 0;
}

void log_nothing(void*, int, const char*) {}

}  // namespace

ScanCrs scan_crs_of(const std::string& wkt) {
  ScanCrs out{wkt, "the coordinate reference system of the scans"};
  if (wkt.empty() || wkt.find('\0') != std::string::npos) return out;
  const ProjContext context = start_proj(log_nothing, nullptr);
  if (!context) return out;
  const ProjObject crs(proj_create_from_wkt(context.get(), wkt.c_str(), nullptr, nullptr, nullptr));
  if (!crs || proj_is_crs(crs.get()) == 0) return out;
  if (const char* name = proj_get_name(crs.get())) out.name = name;
  const char* const options[] = {"MULTILINE=NO", nullptr};
  if (const char* text = proj_as_wkt(context.get(), crs.get(), PJ_WKT1_GDAL, options)) {
    out.wkt = text;
  }
  out.epsg = epsg_of(crs.get());
  out.horizontal_epsg = horizontal_epsg_of(context.get(), crs.get());
  return out;
}

ScanCrs scan_crs_of_epsg(std::uint16_t code) {
  ScanCrs out{"", "EPSG:" + std::to_string(code), code, code};
  const ProjContext context = start_proj(log_nothing, nullptr);
  if (!context) return out;
  const ProjObject crs(proj_create_from_database(
      context.get(), "EPSG", std::to_string(code).c_str(), PJ_CATEGORY_CRS, 0, nullptr));
  if (!crs) return out;
  if (const char* name = proj_get_name(crs.get())) out.name = name;
  out.horizontal_epsg = horizontal_epsg_of(context.get(), crs.get());
  return out;
}

}  // namespace clearway
