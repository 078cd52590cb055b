#pragma once

#include <cuda_runtime_api.h>

#include <cstddef>
#include <span>
#include <string>
#include <utility>

#include "gpu/cuda_check.hpp"

namespace clearway {

/// Owner of `count` uninitialised values in page-locked host memory, which devices copy from and to
/// by themselves. Throws ResourceError where there is none.
template <typename Value>
class PinnedBuffer {
 public:
  explicit PinnedBuffer(std::size_t count) : count_(count) {
    if (count == 0) return;
    const cudaError_t status = cudaHostAlloc(&data_, bytes(), cudaHostAllocPortable);
    if (status == cudaErrorMemoryAllocation) {
      throw ResourceError("no " + std::to_string(bytes()) +
                              " bytes of page-locked host memory: " + cudaGetErrorString(status),
                          Remedy::kLessMemory);
    }
    check_cuda(status);
  }
  PinnedBuffer(PinnedBuffer&& other) noexcept
      : data_(std::exchange(other.data_, nullptr)), count_(std::exchange(other.count_, 0)) {}
  PinnedBuffer& operator=(PinnedBuffer&& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(count_, other.count_);
    return *this;
  }
  ~PinnedBuffer() { cudaFreeHost(data_); }

  Value* data() const { return static_cast<Value*>(data_); }
  std::size_t size() const { return count_; }
  std::size_t bytes() const { return count_ * sizeof(Value); }
  std::span<Value> span() const { return {data(), count_}; }

 private:
  void* data_ = nullptr;
  std::size_t count_;
};

}  // namespace clearway
