#pragma once

#include <chrono>

namespace clearway {

/// Wall-clock time since the stopwatch was made, or since the last lap.
class Stopwatch {
 public:
  double seconds() const { return seconds_until(Clock::now()); }

  /// The seconds of this lap; starts the next one.
  double lap() {
    const Clock::time_point now = Clock::now();
    const double seconds = seconds_until(now);
    start_ = now;
    return seconds;
  }

 private:
  using Clock = std::chrono::steady_clock;

  double seconds_until(Clock::time_point now) const {
    return std::chrono::duration<double>(now - start_).count();
  }

  Clock::time_point start_ = Clock::now();
};

}  // namespace clearway
