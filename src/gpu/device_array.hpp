#pragma once

#include "gpu/device_buffer.hpp"

namespace clearway {

/// A copy of `count` values on the current device. It may still be under way, though the values
/// have been read: streams that do not wait for the legacy default stream begin after a
/// cudaDeviceSynchronize.
template <typename Value>
DeviceBuffer<Value> copied_to_device(const Value* values, std::size_t count) {
  DeviceBuffer<Value> out(count);
  if (count > 0) {
    check_cuda(cudaMemcpy(out.data(), values, out.bytes(), cudaMemcpyHostToDevice));
  }
  return out;
}

}  // namespace clearway
