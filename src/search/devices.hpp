#pragma once

#include <cstdint>
#include <functional>
#include <future>
#include <string>
#include <vector>

#include "clearway/search.hpp"
#include "core/messages/messages.hpp"
#include "gpu/devices.hpp"

namespace clearway {

/// The device or devices on which the engine of a run works.
struct DeviceChoice {
  std::vector<int> gpus;           ///< CUDA's indices of the GPUs; empty for the CPU
  std::string name = "the CPU";    ///< name for people
  std::uint64_t memory_bytes = 0;  ///< bytes that may be taken on each GPU
  /// Name of the GPU with the least free memory, where that is less than was wanted.
  std::string short_device;

  bool is_cuda() const { return !gpus.empty(); }
};

/// Whether there are GPUs that options let a search take. Makes no context. Throws UsageError where
/// the engine has no form for GPUs, and ResourceError, saying what to do, where CUDA is asked for
/// and missing.
bool may_take_gpus(const SearchOptions& options);

/// Whether the CPU may be taken where a GPU fails, because the user named neither a device nor a
/// GPU.
inline bool fallback_allowed(const SearchOptions& options) {
  return options.device == Device::kAuto && options.gpus.empty();
}

/// Chooses by options.device and options.gpus. "auto" takes the first GPU that has all the wanted
/// memory free, or else the one with the most where that is enough, and otherwise the CPU. "cuda"
/// takes all GPUs that are named, or else one as "auto" does. Makes their contexts, so that a
/// thread's current device is then the last of them. Throws ResourceError where CUDA is asked for
/// and cannot be used.
DeviceChoice choose_device(const SearchOptions& options, const MessageLog& log);

/// Whether the process can still use all GPUs of a choice.
bool still_works(const DeviceChoice& choice);

// The steps of the choice, which need no CUDA:

/// Makes the context of a GPU and asks how much memory is free. Throws ResourceError where the GPU
/// cannot be used.
using OpenDevice = std::function<CudaDevice(int)>;

/// A choice of these GPUs, with as much memory as is wanted and free on each.
DeviceChoice choice_of(const std::vector<CudaDevice>& devices, std::uint64_t wanted_bytes);

/// The first of `count` GPUs that has all the wanted memory free, or else the one with the most.
/// That GPU is the last one opened. count is above 0. A GPU that cannot be used is passed over;
/// where none can be used, throws the ResourceError of the last.
CudaDevice one_with_room(int count, const OpenDevice& open, std::uint64_t wanted_bytes,
                         const MessageLog& log);

/// The GPU of one_with_room(), or the CPU where that GPU has too little memory or no GPU can be
/// used.
DeviceChoice automatic_choice(int count, const OpenDevice& open, std::uint64_t wanted_bytes,
                              const MessageLog& log);

/// Starts GPUs on threads of their own: makes their contexts and loads the engine's kernels. A
/// failure is not reported here but where the GPU is used, which tries once more.
class DeviceStart {
 public:
  /// Starts the GPUs that options name, or the first one, all at once. Starts none where options
  /// rule out GPUs.
  explicit DeviceStart(const SearchOptions& options);
  /// kernels: those to load.
  DeviceStart(const SearchOptions& options, CudaKernels kernels);

  /// Waits until all GPUs have started or failed.
  void wait() const;

  /// Wall clock of the slowest start in seconds. Waits until all GPUs have started, and throws what
  /// a start has thrown.
  double seconds() const;

 private:
  std::vector<std::shared_future<double>> starts_;
};

}  // namespace clearway
