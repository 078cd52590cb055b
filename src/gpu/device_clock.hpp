#pragma once

#include "core/page/page_engine.hpp"
#include "gpu/cuda_event.hpp"

namespace clearway {

/// Tells when events of a device happened, on the host's clock. To be made on the current device;
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
