#include "io/conflicts/scan_crs.hpp"

#include <proj.h>

#include <charconv>
#include <memory>
#include <string_view>

namespace clearway {
namespace {

constexpr std::int32_t kGreatestCode = 99'999;  // EPSG's numbers are below

struct Release {
  void operator()(PJ_CONTEXT* context) const { proj_context_destroy(context); }
  void operator()(PJ* object) const { proj_destroy(object); }
};

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

void log_nothing(void*, int, const char*) {}

}  // namespace

ScanCrs scan_crs_of(const std::string& wkt) {
  ScanCrs out{wkt, "the coordinate reference system of the scans", 0};
  if (wkt.empty() || wkt.find('\0') != std::string::npos) return out;
  const std::unique_ptr<PJ_CONTEXT, Release> context(proj_context_create());
  if (!context) return out;
  proj_log_func(context.get(), nullptr, log_nothing);
  const std::unique_ptr<PJ, Release> crs(
      proj_create_from_wkt(context.get(), wkt.c_str(), nullptr, nullptr, nullptr));
  if (!crs || proj_is_crs(crs.get()) == 0) return out;
  if (const char* name = proj_get_name(crs.get())) out.name = name;
  const char* const options[] = {"MULTILINE=NO", nullptr};
  if (const char* text = proj_as_wkt(context.get(), crs.get(), PJ_WKT1_GDAL, options)) {
    out.wkt = text;
  }
  out.epsg = epsg_of(crs.get());
  return out;
}

}  // namespace clearway
