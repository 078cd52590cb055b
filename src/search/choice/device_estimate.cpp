#include "search/choice/device_estimate.hpp"

#include <algorithm>

#include "search/choice/cpu_estimate.hpp"

namespace clearway {
namespace {

// Measured as docs/design/pipeline.md says ("Start and end of a GPU").

/// What a GPU adds to a run, seconds: of its start and end, what nothing runs beside.
constexpr double kStart = 0.5;
/// Cores that search as fast as a GPU does.
constexpr double kCores = 350;
/// How much longer a search on the CPU takes with distances beyond the radius.
constexpr double kDistances = 6;
/// Environment points that a core searches in a second.
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
