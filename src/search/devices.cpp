#include "search/devices.hpp"

#include <algorithm>
#include <exception>
#include <optional>

#include "clearway/error.hpp"
#include "core/util/format.hpp"
#include "core/util/stopwatch.hpp"
#include "search/check_query.hpp"

namespace clearway {
namespace {

/// "auto" leaves a GPU alone that has less than this free.
constexpr std::uint64_t kLeastRoom = std::uint64_t{256} << 20;

/// What may be taken of a device: never quite all that is free, for others take some too.
std::uint64_t allowance(const CudaDevice& device, std::uint64_t wanted_bytes) {
  return std::min(wanted_bytes, device.free_bytes - device.free_bytes / 20);
}

std::string name_of(const CudaDevice& device) {
  return "GPU " + std::to_string(device.index) + " (" + device.name + ", " +
         format_size(device.free_bytes) + " free)";
}

#ifdef CLEARWAY_CUDA

std::uint64_t wanted_bytes_of(const SearchOptions& options) {
  constexpr std::uint64_t kUsualBytes = std::uint64_t{2} << 30;
  return options.device_memory_bytes > 0 ? options.device_memory_bytes : kUsualBytes;
}

std::vector<CudaDevice> open_named(const std::vector<int>& gpus) {
  const int count = cuda_device_count();
  std::vector<CudaDevice> devices;
  for (const int gpu : gpus) {
    if (gpu < 0 || gpu >= count) {
      throw ResourceError("GPU " + std::to_string(gpu) + ": this machine has " +
                          std::to_string(count) + " that CUDA can use, numbered from 0");
    }
    devices.push_back(open_cuda_device(gpu));
  }
  return devices;
}

DeviceChoice choose_cuda(const SearchOptions& options, const MessageLog& log) {
  if (const std::string why = why_no_cuda_device(); !why.empty()) {
    throw ResourceError("device cuda: " + why, Remedy::kCpuDevice);
  }
  const std::uint64_t wanted = wanted_bytes_of(options);
  if (!options.gpus.empty()) return choice_of(open_named(options.gpus), wanted);
  return choice_of({one_with_room(cuda_device_count(), open_cuda_device, wanted, log)}, wanted);
}

DeviceChoice choose_automatically(const SearchOptions& options, const MessageLog& log) {
  return automatic_choice(cuda_device_count(), open_cuda_device, wanted_bytes_of(options), log);
}

#else

DeviceChoice choose_cuda(const SearchOptions&, const MessageLog&) {
  throw ResourceError(
      "device cuda: this build has no CUDA engine (Clearway has one where it is built with nvcc)",
      Remedy::kCpuDevice);
}

DeviceChoice choose_automatically(const SearchOptions&, const MessageLog&) { return {}; }

#endif

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
      CudaDevice device = open(gpu);  // most of a second: no more of them than needed
      if (allowance(device, wanted_bytes) == wanted_bytes) return device;
      if (!best || device.free_bytes > best->free_bytes) best = device;
    } catch (const ResourceError& error) {
      log.note("GPU " + std::to_string(gpu) + " is passed over: " + error.what());
      last = std::current_exception();
    }
  }
  if (!best) std::rethrow_exception(last);
  return open(best->index);  // the last one asked is the current one
}

DeviceChoice automatic_choice(int count, const OpenDevice& open, std::uint64_t wanted_bytes,
                              const MessageLog& log) {
  if (count == 0) return {};
  try {
    const CudaDevice device = one_with_room(count, open, wanted_bytes, log);
    if (device.free_bytes >= kLeastRoom) {
      DeviceChoice choice = choice_of({device}, wanted_bytes);
      choice.fallback_allowed = true;
      return choice;
    }
    log.note("the CPU is taken: " + name_of(device) + " has too little");
  } catch (const ResourceError& error) {
    log.note(std::string("the CPU is taken: ") + error.what());
  }
  return {};
}

DeviceChoice choose_device(const SearchOptions& options, const MessageLog& log) {
  if (chosen_engine(options) == Engine::kKdtree || options.device == Device::kCpu) return {};
  const Stopwatch clock;
  const bool cuda = options.device == Device::kCuda || !options.gpus.empty();
  DeviceChoice choice = cuda ? choose_cuda(options, log) : choose_automatically(options, log);
  if (choice.is_cuda()) choice.context_seconds = clock.seconds();
  return choice;
}

}  // namespace clearway
