#pragma once

#include <cuda_runtime_api.h>

#include <source_location>
#include <string>

#include "clearway/error.hpp"

namespace clearway {

/// Throws ResourceError naming the call's place and CUDA's reason if a call failed. To be used
/// after a kernel launch as check_cuda(cudaGetLastError()).
inline void check_cuda(cudaError_t status,
                       std::source_location where = std::source_location::current()) {
  if (status == cudaSuccess) return;
  throw ResourceError(
      std::string("CUDA failed at ") + where.file_name() + ":" + std::to_string(where.line()) +
          ": " + cudaGetErrorString(status),
      status == cudaErrorMemoryAllocation ? Remedy::kLessDeviceMemory : Remedy::kCpuDevice);
}

}  // namespace clearway
