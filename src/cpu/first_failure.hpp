#pragma once

#include <atomic>
#include <exception>
#include <mutex>

namespace clearway {

/// Keeps the first exception of a parallel region until the region is over.
class FirstFailure {
 public:
  bool happened() const { return happened_.load(std::memory_order_relaxed); }

  void keep_current() {
    const std::lock_guard lock(mutex_);
    if (!failure_) failure_ = std::current_exception();
    happened_.store(true, std::memory_order_relaxed);
  }

  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  std::mutex mutex_;
  std::exception_ptr failure_;
  std::atomic<bool> happened_ = false;
};

}  // namespace clearway
