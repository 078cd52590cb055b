#include "search/choice/cpu_estimate.hpp"

#include <algorithm>
#include <cmath>

namespace clearway {
namespace {

// Measured: least squares of the logarithms of the whole command's CPU seconds, over every second
// question of `clearway-bench choice` (docs/design/choice.md).

double sweep_seconds(const Workload& work, int threads) {
  const double alone = 0.064 + 7.02e-7 * work.model_points + 3.0e-6 * work.poses;
  const double search = 1.80e-5 * std::pow(work.reached_points, 0.3) *
                        std::pow(std::log(work.poses + 2), 3.91) *
                        std::pow(work.model_points, -0.135) * std::pow(work.poses, 0.0525);
  return alone + search / threads;
}

double kdtree_seconds(const Workload& work, int threads) {
  const double alone = 0.003 + 4.93e-7 * work.model_points;
  const double nearness = 9.42e-3 * std::pow(std::max(work.near_points, 1.0), -0.141) +
                          2.61e-9 * std::pow(work.near_points, 1.5);
  const double search = 8.18e-10 * work.points +
                        std::pow(work.poses, 0.638) *
                            std::pow(work.path_length + work.model_length, 0.0914) * nearness;
  return alone + search / threads;
}

}  // namespace

CpuEstimate estimate_on_cpu(const Workload& work, int threads) {
  if (work.model_points == 0 || work.poses == 0) return {};
  return {sweep_seconds(work, threads), kdtree_seconds(work, threads)};
}

}  // namespace clearway
