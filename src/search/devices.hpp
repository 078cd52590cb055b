#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "clearway/search.hpp"
#include "core/util/message_log.hpp"
#include "gpu/devices.hpp"

namespace clearway {

/// Where a run's engine works.
struct DeviceChoice {
  std::vector<int> gpus;           ///< CUDA's numbers; none: the CPU
  std::string name = "the CPU";    ///< for people
  std::uint64_t memory_bytes = 0;  ///< that may be taken on each GPU
  std::string short_device;        ///< the one with the least free, where that is the bound

  bool is_cuda() const { return !gpus.empty(); }
};

/// Whether there are GPUs that options let a search take. No context is made. Throws UsageError
/// where the engine has no such form, ResourceError, saying what to do, where CUDA is asked for and
/// not there.
bool may_take_gpus(const SearchOptions& options);

/// Whether the CPU may be taken where a GPU fails: nobody asked for one.
inline bool fallback_allowed(const SearchOptions& options) {
  return options.device == Device::kAuto && options.gpus.empty();
}

/// Chooses by options.device and options.gpus: "auto" takes the first GPU with all the memory that
/// is wanted free, or else the one with the most where that is enough, and the CPU otherwise;
/// "cuda" all that are named, or the same one. Makes their contexts: a thread's current device is
/// then the last of them. Throws ResourceError where CUDA is asked for and cannot be used.
DeviceChoice choose_device(const SearchOptions& options, const MessageLog& log);

// What it goes by, without CUDA:

/// Makes a GPU's context and asks what is free. Throws ResourceError where it cannot be used.
using OpenDevice = std::function<CudaDevice(int)>;

/// The GPUs, with as much of their memory as is wanted and free on each.
DeviceChoice choice_of(const std::vector<CudaDevice>& devices, std::uint64_t wanted_bytes);

/// The first of `count` GPUs, above 0, with all that is wanted free, or else the one with the most;
/// it is the last one opened. One that cannot be used is passed over; throws ResourceError of the
/// last where that is all of them.
CudaDevice one_with_room(int count, const OpenDevice& open, std::uint64_t wanted_bytes,
                         const MessageLog& log);

/// That one, or the CPU where it has too little, or there is none that can be used.
DeviceChoice automatic_choice(int count, const OpenDevice& open, std::uint64_t wanted_bytes,
                              const MessageLog& log);

}  // namespace clearway
