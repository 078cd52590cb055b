#pragma once

#include <mutex>
#include <string>

#include "clearway/progress.hpp"
#include "core/util/progress.hpp"

namespace clearway {

/// Tells the caller of a long operation how far it is, and tells the operation whether the caller
/// wants it to stop.
class CallbackProgress final : public Progress {
 public:
  /// Tell and stop must outlive this object.
  CallbackProgress(const ProgressCallback& tell, StopFlag stop) : callback_(tell), stop_(stop) {}

  void begin(std::string_view stage, std::uint64_t total, std::string_view unit) override {
    const std::lock_guard lock(mutex_);
    stage_ = stage;
    unit_ = unit;
    total_ = total;
    done_ = 0;
    tell(false);
  }
  void advance(std::uint64_t units) override {
    const std::lock_guard lock(mutex_);
    done_ += units;
    tell(false);
  }
  void end() override {
    const std::lock_guard lock(mutex_);
    tell(true);
  }
  bool stop_requested() const override {
    return stop_ != nullptr && stop_->load(std::memory_order_relaxed);
  }

 private:
  void tell(bool finished) const {
    if (callback_) callback_({stage_, done_, total_, unit_, finished});
  }

  const ProgressCallback& callback_;
  const StopFlag stop_;
  std::mutex mutex_;
  std::string stage_, unit_;
  std::uint64_t total_ = 0, done_ = 0;
};

}  // namespace clearway
