#include "cli/campaign/run_estimate.hpp"

#include <algorithm>
#include <cmath>

#include "io/store/store_reader.hpp"
#include "search/choice/device_estimate.hpp"
#include "search/choice/workload.hpp"

namespace clearway::tool {

std::uint32_t RunEstimate::shards(const RunOptions& run,
                                  const std::vector<EstimatedModel>& models) {
  if (!is_asked_for()) return 1;
  if (!store_ || store_->path() != run.environment) store_.emplace(run.environment);
  std::vector<Workload> work;
  for (const auto& [box, points, poses] : models) {
    work.push_back(workload_of(store_->reader(), run.query, box, points, poses));
  }
  const DeviceEstimate seconds =
      estimate_devices(work, run.query, run.search.engine, std::max(run.search.threads, 1));
  const double needed = run.search.device == Device::kCuda ? seconds.cuda : seconds.cpu;
  return static_cast<std::uint32_t>(
      std::clamp(std::ceil(needed / shard_seconds_), 1.0, double{Shard::kMost}));
}

}  // namespace clearway::tool
