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

/// How many CUDA devices this machine offers; 0 where there is none, or no driver for them.
int cuda_device_count();

/// Why there are none, in CUDA's words; empty where there is one.
std::string why_no_cuda_device();

/// Its name, without making its context. Throws ResourceError.
std::string cuda_device_name(int index);

/// Makes the device's context, which takes a while, and asks what is free. Throws ResourceError.
CudaDevice open_cuda_device(int index);

/// Makes its context and loads the kernels of an engine, so that nothing waits for that later. It
/// may run beside anything; what fails, fails again where the device is opened.
void start_cuda_device(int index, bool grid) noexcept;

/// Ends its context, and with it all that the process has there.
void end_cuda_device(int index) noexcept;

}  // namespace clearway
