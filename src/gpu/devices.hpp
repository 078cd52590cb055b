#pragma once

#include <cstdint>
#include <string>

namespace clearway {

struct CudaDevice {
  int index;
  std::string name;
  std::uint64_t total_bytes;
  std::uint64_t free_bytes;
};

/// Number of CUDA devices of this machine; 0 if there is none, or no driver for them.
int cuda_device_count();

/// Why there is no CUDA device, in CUDA's words; empty if there is one.
std::string why_no_cuda_device();

/// The name of a device, without creating its context. Throws ResourceError.
std::string cuda_device_name(int index);

/// Creates the device's context, which takes a while, and asks how much memory is free. Throws
/// ResourceError.
CudaDevice open_cuda_device(int index);

/// Whether the process can still use a device that it has opened. A fault in a kernel ends that,
/// for all work of the process there. Takes microseconds.
bool cuda_device_works(int index) noexcept;

/// What a device is started for.
enum class CudaKernels { kSweep, kGrid, kSection };

/// Creates the device's context and loads kernels, so that nothing waits for that later. May run at
/// the same time as anything else. A failure is ignored here, and occurs again when the device is
/// opened.
void start_cuda_device(int index, CudaKernels kernels) noexcept;

/// Ends the device's context, and with it everything that the process has there.
void end_cuda_device(int index) noexcept;

}  // namespace clearway
