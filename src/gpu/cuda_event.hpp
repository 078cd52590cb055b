#pragma once

#include <cuda_runtime_api.h>

#include <utility>

#include "gpu/cuda_check.hpp"

namespace clearway {

/// Owner of an event with a time stamp, on the device that is current when it is made. A thread
/// that waits for the event sleeps.
class CudaEvent {
 public:
  CudaEvent() { check_cuda(cudaEventCreateWithFlags(&event_, cudaEventBlockingSync)); }
  CudaEvent(CudaEvent&& other) noexcept : event_(std::exchange(other.event_, nullptr)) {}
  ~CudaEvent() {
    if (event_ != nullptr) cudaEventDestroy(event_);
  }

  cudaEvent_t get() const { return event_; }

  /// Records the event: enqueued on `stream`, not synchronised.
  void record(cudaStream_t stream) const { check_cuda(cudaEventRecord(event_, stream)); }

  /// Waits until the event has happened. Throws the error of the work before it.
  void synchronise() const { check_cuda(cudaEventSynchronize(event_)); }

  /// Seconds from `earlier` to this event; both must have happened.
  double seconds_since(const CudaEvent& earlier) const {
    float milliseconds = 0;
    check_cuda(cudaEventElapsedTime(&milliseconds, earlier.event_, event_));
    return 1e-3 * static_cast<double>(milliseconds);
  }

 private:
  cudaEvent_t event_ = nullptr;
};

}  // namespace clearway
