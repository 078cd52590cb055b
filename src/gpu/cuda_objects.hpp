#pragma once

#include <cuda_runtime_api.h>

#include <source_location>
#include <string>
#include <utility>

#include "clearway/error.hpp"
#include "core/page/page_engine.hpp"

namespace clearway {

/// Throws the ResourceError of a call that failed: it names the call's place and CUDA's reason, and
/// says so where the process can use the device no more.
[[noreturn]] void throw_cuda_error(cudaError_t status, std::source_location where);

/// Throws as throw_cuda_error() if a call failed. To be used after a kernel launch as
/// check_cuda(cudaGetLastError()).
inline void check_cuda(cudaError_t status,
                       std::source_location where = std::source_location::current()) {
  if (status != cudaSuccess) throw_cuda_error(status, where);
}

/// Owner of a stream on the device that is current when it is made. The stream does not wait for
/// the legacy default stream.
class CudaStream {
 public:
  CudaStream() { check_cuda(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking)); }
  CudaStream(CudaStream&& other) noexcept : stream_(std::exchange(other.stream_, nullptr)) {}
  ~CudaStream() {
    if (stream_ != nullptr) cudaStreamDestroy(stream_);
  }

  cudaStream_t get() const { return stream_; }

 private:
  cudaStream_t stream_ = nullptr;
};

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

  /// Lets what is enqueued on `stream` from now on begin only after the recorded event.
  void before(cudaStream_t stream) const { check_cuda(cudaStreamWaitEvent(stream, event_)); }

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

/// Finds the times of a device's events on the host's clock. To be made on the current device;
/// synchronous.
class DeviceClock {
 public:
  DeviceClock() {
    base_.record(nullptr);
    base_.synchronise();
    base_time_ = Clock::now();
  }

  /// Time of an event that has happened.
  Clock::time_point time_of(const CudaEvent& event) const {
    return base_time_ + std::chrono::duration_cast<Clock::duration>(
                            std::chrono::duration<double>(event.seconds_since(base_)));
  }

 private:
  CudaEvent base_;  ///< happened at base_time_
  Clock::time_point base_time_;
};

}  // namespace clearway
