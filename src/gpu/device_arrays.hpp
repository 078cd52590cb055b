#pragma once

#include <cuda_runtime_api.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/util/array_run.hpp"
#include "gpu/cuda_objects.hpp"

namespace clearway {

/// Owner of uninitialised memory of the current device. Throws ResourceError if there is not
/// enough.
class DeviceBuffer {
 public:
  explicit DeviceBuffer(std::size_t bytes) : bytes_(bytes) {
    if (bytes > 0) check_cuda(cudaMalloc(&data_, bytes));
  }
  DeviceBuffer(DeviceBuffer&& other) noexcept
      : data_(std::exchange(other.data_, nullptr)), bytes_(std::exchange(other.bytes_, 0)) {}
  ~DeviceBuffer() { cudaFree(data_); }

  std::byte* data() const { return static_cast<std::byte*>(data_); }
  std::size_t bytes() const { return bytes_; }

 private:
  void* data_ = nullptr;
  std::size_t bytes_;
};

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

/// Arrays on the current device, filled and owned together. A copy may still be under way when a
/// call returns, although its values have been read: streams that do not wait for the legacy
/// default stream must begin after a cudaDeviceSynchronize. Throws ResourceError.
class DeviceArrays {
 public:
  DeviceArrays() = default;
  /// Takes memory of others first, which outlives the arrays and is not counted in bytes().
  explicit DeviceArrays(std::span<std::byte> memory) : memory_(memory) {}

  template <typename Value>
  const Value* copy(const Value* values, std::size_t count) {
    Value* to = add<Value>(count);
    if (count > 0)
      check_cuda(cudaMemcpy(to, values, count * sizeof(Value), cudaMemcpyHostToDevice));
    return to;
  }

  template <typename Value>
  Value* zeros(std::size_t count) {
    return filled<Value>(count, 0);
  }

  /// Values all of whose bits are 1.
  template <typename Value>
  Value* ones(std::size_t count) {
    return filled<Value>(count, 0xff);
  }

  std::uint64_t bytes() const {
    std::uint64_t sum = 0;
    for (const DeviceBuffer& buffer : buffers_) sum += buffer.bytes();
    return sum;
  }

 private:
  template <typename Value>
  Value* filled(std::size_t count, int byte) {
    Value* to = add<Value>(count);
    if (count > 0) check_cuda(cudaMemset(to, byte, count * sizeof(Value)));
    return to;
  }

  template <typename Value>
  Value* add(std::size_t count) {
    const std::uint64_t bytes = ArrayRun::aligned(count * sizeof(Value));
    if (bytes <= memory_.size()) {
      std::byte* const begin = memory_.data();
      memory_ = memory_.subspan(bytes);
      return reinterpret_cast<Value*>(begin);
    }
    return reinterpret_cast<Value*>(buffers_.emplace_back(count * sizeof(Value)).data());
  }

  std::span<std::byte> memory_;
  std::vector<DeviceBuffer> buffers_;
};

/// Counts the memory that DeviceArrays would allocate for the same calls, and allocates none.
class DeviceArrayCount {
 public:
  /// Bytes in which all of the arrays fit one after another, each aligned as an allocation.
  std::uint64_t bytes_in_a_run() const { return run_bytes_; }

  template <typename Value>
  const Value* copy(const Value*, std::size_t count) {
    return zeros<Value>(count);
  }

  template <typename Value>
  Value* zeros(std::size_t count) {
    bytes_ += count * sizeof(Value);
    run_bytes_ += ArrayRun::aligned(count * sizeof(Value));
    return nullptr;
  }

  template <typename Value>
  Value* ones(std::size_t count) {
    return zeros<Value>(count);
  }

  std::uint64_t bytes() const { return bytes_; }

 private:
  std::uint64_t bytes_ = 0, run_bytes_ = 0;
};

}  // namespace clearway
