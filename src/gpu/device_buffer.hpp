#pragma once

#include <cstddef>
#include <utility>

#include "gpu/cuda_check.hpp"

namespace clearway {

/// Owner of `count` uninitialised values in device memory. Throws ResourceError where there is
/// none.
template <typename Value>
class DeviceBuffer {
 public:
  explicit DeviceBuffer(std::size_t count) {
    if (count > 0) check_cuda(cudaMalloc(&data_, count * sizeof(Value)));
  }
  DeviceBuffer(DeviceBuffer&& other) noexcept : data_(std::exchange(other.data_, nullptr)) {}
  DeviceBuffer& operator=(DeviceBuffer&& other) noexcept {
    std::swap(data_, other.data_);
    return *this;
  }
  ~DeviceBuffer() { cudaFree(data_); }

  Value* data() const { return static_cast<Value*>(data_); }

 private:
  void* data_ = nullptr;
};

}  // namespace clearway
