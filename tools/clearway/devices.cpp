#include "clearway/devices.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <optional>

#include "clearway/options.hpp"
#include "core/error.hpp"
#include "core/stopwatch.hpp"
#ifdef CLEARWAY_CUDA
#include "gpu/devices.hpp"
#endif

namespace clearway::tool {
namespace {

void refuse_cuda_for_kdtree() {
  throw UsageError("--device cuda: engine kdtree runs on the CPU alone; take --engine sweep");
}

#ifdef CLEARWAY_CUDA

constexpr std::uint64_t kUsualBytes = std::uint64_t{2} << 30;
/// "auto" leaves a GPU alone that has less than this free.
constexpr std::uint64_t kLeastRoom = std::uint64_t{256} << 20;

std::uint64_t wanted_bytes(const EngineOptions& options) {
  return options.device_memory_bytes > 0 ? options.device_memory_bytes : kUsualBytes;
}

/// What may be taken of a device: never quite all that is free, for others take some too.
std::uint64_t allowance(const EngineOptions& options, const CudaDevice& device) {
  return std::min(wanted_bytes(options), device.free_bytes - device.free_bytes / 20);
}

DeviceChoice choice_of(const EngineOptions& options, const std::vector<CudaDevice>& devices) {
  DeviceChoice choice;
  choice.name.clear();
  choice.memory_bytes = allowance(options, devices.front());
  for (const CudaDevice& device : devices) {
    choice.gpus.push_back(device.index);
    choice.name += (choice.name.empty() ? "" : " and ") + std::string("GPU ") +
                   std::to_string(device.index) + " (" + device.name + ", " +
                   format_size(device.free_bytes) + " free)";
    choice.memory_bytes = std::min(choice.memory_bytes, allowance(options, device));
  }
  return choice;
}

std::vector<CudaDevice> open_named(const std::vector<int>& gpus) {
  const int count = cuda_device_count();
  std::vector<CudaDevice> devices;
  for (const int gpu : gpus) {
    if (gpu < 0 || gpu >= count) {
      throw ResourceError("--gpus " + std::to_string(gpu) + ": this machine has " +
                          std::to_string(count) + " that CUDA can use, numbered from 0");
    }
    devices.push_back(open_cuda_device(gpu));
  }
  return devices;
}

/// The first with all that is wanted, or else the one with the most: to ask a device takes a
/// context on it, most of a second.
CudaDevice open_one_with_room(const EngineOptions& options) {
  std::optional<CudaDevice> best;
  for (int gpu = 0; gpu < cuda_device_count(); ++gpu) {
    const CudaDevice device = open_cuda_device(gpu);
    if (allowance(options, device) == wanted_bytes(options)) return device;
    if (!best || device.free_bytes > best->free_bytes) best = device;
  }
  return open_cuda_device(best.value().index);  // the last one asked is the current one
}

DeviceChoice choose_cuda(const EngineOptions& options) {
  if (const std::string why = why_no_cuda_device(); !why.empty()) {
    throw ResourceError((options.gpus.empty() ? "--device cuda: " : "--gpus: ") + why +
                        "; take --device cpu, or run where nvidia-smi lists a GPU");
  }
  return choice_of(options, options.gpus.empty() ? std::vector{open_one_with_room(options)}
                                                 : open_named(options.gpus));
}

DeviceChoice choose_automatically(const EngineOptions& options) {
  if (cuda_device_count() == 0) return {};
  try {
    const CudaDevice device = open_one_with_room(options);
    if (device.free_bytes >= kLeastRoom) return choice_of(options, {device});
    spdlog::info("GPU {} has only {} free: the CPU is taken", device.index,
                 format_size(device.free_bytes));
  } catch (const ResourceError& error) {
    spdlog::info("the CPU is taken: {}", error.what());
  }
  return {};
}

#else

DeviceChoice choose_cuda(const EngineOptions&) {
  throw ResourceError(
      "--device cuda: this build has no CUDA engine; take --device cpu, or build Clearway where "
      "nvcc is found and run it where nvidia-smi lists a GPU");
}

DeviceChoice choose_automatically(const EngineOptions&) { return {}; }

#endif

}  // namespace

DeviceChoice choose_device(const EngineOptions& options) {
  const bool cuda = options.device == "cuda" || !options.gpus.empty();
  if (options.engine == "kdtree") {
    if (cuda) refuse_cuda_for_kdtree();
    return {};
  }
  if (options.device == "cpu") return {};
  const Stopwatch clock;
  DeviceChoice choice = cuda ? choose_cuda(options) : choose_automatically(options);
  if (choice.is_cuda()) choice.context_seconds = clock.seconds();
  return choice;
}

}  // namespace clearway::tool
