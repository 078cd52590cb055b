#include "search/devices.hpp"

#include <algorithm>
#include <exception>
#include <optional>

#include "clearway/error.hpp"
#include "core/util/format.hpp"
#include "core/util/stopwatch.hpp"
#include "core/util/threads.hpp"
#include "io/files/thread_limit.hpp"
#include "io/store/store_reader.hpp"
#include "search/device_estimate.hpp"

namespace clearway {

#ifndef CLEARWAY_CUDA

// A build without CUDA never has a device.
int cuda_device_count() { return 0; }
std::string why_no_cuda_device() {
  return "this build has no CUDA engine (Clearway has one where it is built with nvcc)";
}
CudaDevice open_cuda_device(int) { return {}; }
bool cuda_device_works(int) noexcept { return false; }

#endif

namespace {

/// Device "auto" does not take a GPU that has less than this free, in bytes.
constexpr std::uint64_t kLeastRoom = std::uint64_t{256} << 20;

/// The memory in bytes that may be taken of a device. It is never quite all that is free, because
/// others take some too.
std::uint64_t allowance(const CudaDevice& device, std::uint64_t wanted_bytes) {
  return std::min(wanted_bytes, device.free_bytes - device.free_bytes / 20);
}

std::string name_of(const CudaDevice& device) {
  return "GPU " + std::to_string(device.index) + " (" + device.name + ", " +
         format_size(device.free_bytes) + " free)";
}

std::uint64_t wanted_bytes_of(const SearchOptions& options) {
  constexpr std::uint64_t kUsualBytes = std::uint64_t{2} << 30;
  return options.device_memory_bytes > 0 ? options.device_memory_bytes : kUsualBytes;
}

void refuse_missing(const std::vector<int>& gpus) {
  if (const std::string why = why_no_cuda_device(); !why.empty()) {
    throw ResourceError("device cuda: " + why, Remedy::kCpuDevice);
  }
  const int count = cuda_device_count();
  for (const int gpu : gpus) {
    if (gpu >= 0 && gpu < count) continue;
    throw ResourceError("GPU " + std::to_string(gpu) + ": this machine has " +
                        std::to_string(count) + " that CUDA can use, numbered from 0");
  }
}

}  // namespace

DeviceChoice choice_of(const std::vector<CudaDevice>& devices, std::uint64_t wanted_bytes) {
  DeviceChoice choice;
  choice.name.clear();
  choice.memory_bytes = wanted_bytes;
  for (const CudaDevice& device : devices) {
    choice.gpus.push_back(device.index);
    choice.name += (choice.name.empty() ? "" : " and ") + name_of(device);
    const std::uint64_t allowed = allowance(device, wanted_bytes);
    if (allowed >= choice.memory_bytes) continue;
    choice.memory_bytes = allowed;
    choice.short_device = name_of(device);
  }
  return choice;
}

CudaDevice one_with_room(int count, const OpenDevice& open, std::uint64_t wanted_bytes,
                         const MessageLog& log) {
  std::optional<CudaDevice> best;
  std::exception_ptr last;
  for (int gpu = 0; gpu < count; ++gpu) {
    try {
      CudaDevice device = open(gpu);  // takes most of a second
      if (allowance(device, wanted_bytes) == wanted_bytes) return device;
      if (!best || device.free_bytes > best->free_bytes) best = device;
    } catch (const ResourceError& error) {
      log.note("GPU " + std::to_string(gpu) + " is passed over: " + error.what());
      last = std::current_exception();
    }
  }
  if (!best) std::rethrow_exception(last);
  return open(best->index);  // the GPU that was opened last becomes the current one
}

DeviceChoice automatic_choice(int count, const OpenDevice& open, std::uint64_t wanted_bytes,
                              const MessageLog& log) {
  if (count == 0) return {};
  try {
    const CudaDevice device = one_with_room(count, open, wanted_bytes, log);
    if (device.free_bytes >= kLeastRoom) return choice_of({device}, wanted_bytes);
    log.note("the CPU is taken: " + name_of(device) + " has too little");
  } catch (const ResourceError& error) {
    log.note(std::string("the CPU is taken: ") + error.what());
  }
  return {};
}

bool may_take_gpus(const SearchOptions& options) {
  if (options.engine == Engine::kKdtree || options.device == Device::kCpu) return false;
  if (fallback_allowed(options)) return cuda_device_count() > 0;
  refuse_missing(options.gpus);
  return true;
}

DeviceChoice choose_device(const SearchOptions& options, const MessageLog& log) {
  const std::uint64_t wanted = wanted_bytes_of(options);
  if (fallback_allowed(options)) {
    return automatic_choice(cuda_device_count(), open_cuda_device, wanted, log);
  }
  std::vector<CudaDevice> devices;
  for (const int gpu : options.gpus) devices.push_back(open_cuda_device(gpu));
  if (devices.empty()) {
    devices.push_back(one_with_room(cuda_device_count(), open_cuda_device, wanted, log));
  }
  return choice_of(devices, wanted);
}

bool still_works(const DeviceChoice& choice) {
  return std::ranges::all_of(choice.gpus, cuda_device_works);
}

DeviceStart::DeviceStart(const SearchOptions& options)
    : DeviceStart(options,
                  options.engine == Engine::kGrid ? CudaKernels::kGrid : CudaKernels::kSweep) {}

#ifdef CLEARWAY_CUDA

DeviceStart::DeviceStart(const SearchOptions& options, CudaKernels kernels) {
  if (options.engine == Engine::kKdtree || options.device == Device::kCpu) return;
  const auto start = [kernels](int gpu) {
    const Stopwatch clock;
    start_cuda_device(gpu, kernels);
    return clock.seconds();
  };
  const std::vector<int> gpus = options.gpus.empty() ? std::vector{0} : options.gpus;
  for (const int gpu : gpus) starts_.push_back(std::async(kBeside, start, gpu).share());
}

#else

DeviceStart::DeviceStart(const SearchOptions&, CudaKernels) {}

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
