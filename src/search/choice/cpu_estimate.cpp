#include "search/choice/cpu_estimate.hpp"

#include <cmath>

namespace clearway {

CpuEstimate estimate_on_cpu(const Workload& work, int threads) {
  const double levels = std::log2(work.poses + 2);
  const double sweep = 2e-7 * work.model_points + 2e-6 * work.poses + 0.05 +
                       5e-7 * work.reached_points * levels / threads;
  const double kdtree = 1e-7 * work.model_points + 5e-7 * work.poses + 1e-9 * work.points +
                        1e-4 * work.poses / threads;
  return {sweep, kdtree};
}

}  // namespace clearway
