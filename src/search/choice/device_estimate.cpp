#include "search/choice/device_estimate.hpp"

#include <algorithm>

#include "search/choice/cpu_estimate.hpp"

namespace clearway {
namespace {

// Measured as docs/design/pipeline.md says ("Start and end of a GPU").

/// Seconds that a GPU adds to a run: the part of its start and end beside which nothing else runs.
constexpr double kStart = 0.5;
/// How many cores of a CPU search as fast as a GPU does.
constexpr double kCores = 350;
/// By what factor a search on the CPU takes longer where it has distances beyond the radius.
constexpr double kDistances = 6;
/// How many environment points a core searches in a second.
constexpr double kPointsPerCore = 13e6;

}  // namespace

DeviceEstimate estimate_devices(std::span<const Workload> work, const QueryParameters& query,
                                Engine engine, int threads) {
  const bool distances = query.clearance > 0 || query.profile > 0;
  const bool may_be_kdtree = engine == Engine::kAuto && !distances && work.size() == 1;
  double set = 0;
  for (const Workload& one : work) {
    const EngineEstimate on_cpu = estimate_on_cpu(one, threads);
    set += may_be_kdtree ? std::min(on_cpu.sweep_seconds, on_cpu.kdtree_seconds)
                         : on_cpu.sweep_seconds;
  }
  const double cpu = (distances ? kDistances : 1) * set;
  return {cpu, kStart + cpu * threads / kCores};
}

std::uint64_t surely_many_points(int threads) {
  return static_cast<std::uint64_t>(kStart * kPointsPerCore * std::max(threads, 1));
}

}  // namespace clearway
