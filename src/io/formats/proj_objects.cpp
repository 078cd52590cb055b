#include "io/formats/proj_objects.hpp"

namespace clearway {

ProjContext start_proj(PJ_LOG_FUNCTION log, void* kept) {
  ProjContext context(proj_context_create());
  if (!context) return context;
  proj_context_set_enable_network(context.get(), 0);
  proj_log_func(context.get(), kept, log);
  return context;
}

double unit_of_axis(PJ_CONTEXT* context, const PJ* crs, int axis) {
  const ProjObject system(proj_crs_get_coordinate_system(context, crs));
  double metres = 0;
  if (!system || proj_cs_get_axis_info(context, system.get(), axis, nullptr, nullptr, nullptr,
                                       &metres, nullptr, nullptr, nullptr) == 0) {
    return 0;
  }
  return metres;
}

}  // namespace clearway
