#pragma once

#include <proj.h>

#include <memory>

namespace clearway {

struct DestroyProj {
  void operator()(PJ_CONTEXT* context) const { proj_context_destroy(context); }
  void operator()(PJ* object) const { proj_destroy(object); }
};
using ProjContext = std::unique_ptr<PJ_CONTEXT, DestroyProj>;
using ProjObject = std::unique_ptr<PJ, DestroyProj>;

/// Starts PROJ without network and silently: messages go to `log`, together with `kept`. Null where
/// PROJ cannot be started.
ProjContext start_proj(PJ_LOG_FUNCTION log, void* kept);

/// Metres per unit of an axis; 0 where there is no such axis.
double unit_of_axis(PJ_CONTEXT* context, const PJ* crs, int axis);

}  // namespace clearway
