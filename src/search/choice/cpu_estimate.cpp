#include "search/choice/cpu_estimate.hpp"

#include <algorithm>
#include <cmath>

namespace clearway {
namespace {

// Measured by `clearway-bench choice`; docs/design/choice.md has the data and the fits.

double sweep_seconds(const Workload& work, int threads) {
  const double alone = 0.064 + 7.02e-7 * work.model_points + 3.0e-6 * work.poses;
  const double search = 1.80e-5 * std::pow(work.reached_points, 0.3) *
                        std::pow(std::log(work.poses + 2), 3.91) *
                        std::pow(work.model_points, -0.135) * std::pow(work.poses, 0.0525);
  return alone + search / threads;
}

/// Time of kdtree divided by that of sweep. This ratio follows from few quantities, while the two
/// times follow from many that they have in common.
double kdtree_ratio(const Workload& work) {
  const double poses = std::log(work.poses), radius = std::log(work.radius);
  return std::exp(-0.0158 + 0.0109 * poses * poses + 0.2487 * radius + 0.0441 * radius * radius);
}

}  // namespace

EngineEstimate estimate_on_cpu(const Workload& work, int threads) {
  if (work.model_points == 0 || work.poses == 0) return {};
  const double sweep = sweep_seconds(work, threads);
  return {sweep, sweep * kdtree_ratio(work)};
}

}  // namespace clearway
