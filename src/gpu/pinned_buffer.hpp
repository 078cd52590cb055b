#pragma once

#include <cuda_runtime_api.h>

#include <cstddef>
#include <string>
#include <utility>

#include "gpu/cuda_check.hpp"

namespace clearway {

/// Owner of uninitialised page-locked host memory, from and to which devices copy by themselves.
/// Throws ResourceError if there is not enough.
class PinnedBuffer {
 public:
  explicit PinnedBuffer(std::size_t bytes) : bytes_(bytes) {
    if (bytes == 0) return;
    const cudaError_t status = cudaHostAlloc(&data_, bytes, cudaHostAllocPortable);
    if (status == cudaErrorMemoryAllocation) {
      throw ResourceError("no " + std::to_string(bytes) +
                              " bytes of page-locked host memory: " + cudaGetErrorString(status),
                          Remedy::kLessMemory);
    }
    check_cuda(status);
  }
  PinnedBuffer(PinnedBuffer&& other) noexcept
      : data_(std::exchange(other.data_, nullptr)), bytes_(std::exchange(other.bytes_, 0)) {}
  ~PinnedBuffer() { cudaFreeHost(data_); }

  std::byte* data() const { return static_cast<std::byte*>(data_); }
  std::size_t bytes() const { return bytes_; }

 private:
  void* data_ = nullptr;
  std::size_t bytes_;
};

}  // namespace clearway
