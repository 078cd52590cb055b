#include "io/formats/las/epsg_unit.hpp"

#include <proj.h>

#include <memory>
#include <string>

namespace clearway {
namespace {

struct DestroyContext {
  void operator()(PJ_CONTEXT* context) const { proj_context_destroy(context); }
};

struct DestroyObject {
  void operator()(PJ* object) const { proj_destroy(object); }
};

using Object = std::unique_ptr<PJ, DestroyObject>;

void keep_quiet(void*, int, const char*) {}

}  // namespace

std::optional<double> unit_of_epsg(std::uint16_t code) {
  const std::unique_ptr<PJ_CONTEXT, DestroyContext> context(proj_context_create());
  if (!context) return std::nullopt;
  proj_context_set_enable_network(context.get(), 0);
  proj_log_func(context.get(), nullptr, keep_quiet);
  const Object crs(proj_create_from_database(context.get(), "EPSG", std::to_string(code).c_str(),
                                             PJ_CATEGORY_CRS, 0, nullptr));
  if (!crs) return std::nullopt;
  const Object axes(proj_crs_get_coordinate_system(context.get(), crs.get()));
  double metres = 0;
  if (!axes || proj_cs_get_axis_info(context.get(), axes.get(), 0, nullptr, nullptr, nullptr,
                                     &metres, nullptr, nullptr, nullptr) == 0) {
    return std::nullopt;
  }
  return metres;
}

}  // namespace clearway
