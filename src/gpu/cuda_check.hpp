#pragma once

#include <cuda_runtime_api.h>

#include <source_location>
#include <string>

#include "clearway/error.hpp"

namespace clearway {

/// Throws ResourceError naming the call's place, CUDA's reason and what to do. After a kernel
/// launch: check_cuda(cudaGetLastError()).
inline void check_cuda(cudaError_t status,
                       std::source_location where = std::source_location::current()) {
  if (status == cudaSuccess) return;
  const char* advice =
      status == cudaErrorMemoryAllocation
          ? "; nvidia-smi lists what else uses the GPU: take less --device-memory, or --device cpu"
          : "; what was finished is kept for --resume; --device cpu does without the GPU";
  throw ResourceError(std::string("CUDA failed at ") + where.file_name() + ":" +
                      std::to_string(where.line()) + ": " + cudaGetErrorString(status) + advice);
}

}  // namespace clearway
