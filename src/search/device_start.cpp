#include "search/device_start.hpp"

#include <algorithm>

#include "core/util/stopwatch.hpp"
#include "io/store/store_reader.hpp"
#include "search/check_query.hpp"
#include "search/choice/device_estimate.hpp"
#include "search/devices.hpp"
#include "search/threads.hpp"

namespace clearway {

#ifdef CLEARWAY_CUDA

DeviceStart::DeviceStart(const SearchOptions& options) {
  const Engine engine = chosen_engine(options);
  if (engine == Engine::kKdtree || options.device == Device::kCpu) return;
  const auto start = [engine](int gpu) {
    const Stopwatch clock;
    start_cuda_device(gpu, engine == Engine::kGrid);
    return clock.seconds();
  };
  const std::vector<int> gpus = options.gpus.empty() ? std::vector{0} : options.gpus;
  for (const int gpu : gpus) starts_.push_back(std::async(start, gpu).share());
}

#else

DeviceStart::DeviceStart(const SearchOptions&) {}

#endif

void DeviceStart::wait() const {
  for (const auto& start : starts_) start.wait();
}

double DeviceStart::seconds() const {
  double seconds = 0;
  for (const auto& start : starts_) seconds = std::max(seconds, start.get());
  return seconds;
}

std::shared_ptr<const DeviceStart> start_devices(const SearchOptions& options, const Store* store) {
  if (fallback_allowed(options)) {
    const int threads = threads_or_all(options.threads);
    if (store == nullptr || store->reader().point_count() < surely_many_points(threads))
      return nullptr;
  }
  return std::make_shared<const DeviceStart>(options);
}

}  // namespace clearway
