#include "io/formats/las/epsg_unit.hpp"

#include <string>

#include "io/formats/proj_objects.hpp"

namespace clearway {
namespace {

void keep_quiet(void*, int, const char*) {}

}  // namespace

std::optional<double> unit_of_epsg(std::uint16_t code) {
  const ProjContext context = start_proj(keep_quiet, nullptr);
  if (!context) return std::nullopt;
  const ProjObject crs(proj_create_from_database(
      context.get(), "EPSG", std::to_string(code).c_str(), PJ_CATEGORY_CRS, 0, nullptr));
  if (!crs) return std::nullopt;
  const double metres = unit_of_axis(context.get(), crs.get(), 0);
  return metres != 0 ? std::optional(metres) : std::nullopt;
}

}  // namespace clearway
