#pragma once

#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>

#include "clearway/error.hpp"
#include "clearway/progress.hpp"

namespace clearway {

/// Receives the progress of a long operation, and may ask it to stop. advance() and
/// stop_requested() may be called from several threads.
class Progress {
 public:
  virtual ~Progress() = default;
  /// Begins a stage of `total` units; total 0 means unknown.
  virtual void begin(std::string_view stage, std::uint64_t total, std::string_view unit) = 0;
  virtual void advance(std::uint64_t units) = 0;
  virtual void end() = 0;
  /// Whether the operation has to finish what is in flight, begin nothing more and throw
  /// Interrupted.
  virtual bool stop_requested() const { return false; }
};

inline void throw_if_stopped(const Progress& progress) {
  if (progress.stop_requested()) throw Interrupted("interrupted");
}

/// A Progress that discards everything.
class NoProgress final : public Progress {
 public:
  void begin(std::string_view, std::uint64_t, std::string_view) override {}
  void advance(std::uint64_t) override {}
  void end() override {}
};

/// Reports to the caller of a long operation how far it is, and to the operation whether the caller
/// wants it to stop.
class CallbackProgress final : public Progress {
 public:
  /// Callback and stop must outlive this object.
  CallbackProgress(const ProgressCallback& callback, StopFlag stop)
      : callback_(callback), stop_(stop) {}

  void begin(std::string_view stage, std::uint64_t total, std::string_view unit) override {
    const std::lock_guard lock(mutex_);
    stage_ = stage;
    unit_ = unit;
    total_ = total;
    done_ = 0;
    report(false);
  }
  void advance(std::uint64_t units) override {
    const std::lock_guard lock(mutex_);
    done_ += units;
    report(false);
  }
  void end() override {
    const std::lock_guard lock(mutex_);
    report(true);
  }
  bool stop_requested() const override {
    return stop_ != nullptr && stop_->load(std::memory_order_relaxed);
  }

 private:
  void report(bool finished) const {
    if (callback_) callback_({stage_, done_, total_, unit_, finished});
  }

  const ProgressCallback& callback_;
  const StopFlag stop_;
  std::mutex mutex_;
  std::string stage_, unit_;
  std::uint64_t total_ = 0, done_ = 0;
};

}  // namespace clearway
