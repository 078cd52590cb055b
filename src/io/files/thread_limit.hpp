#pragma once

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <optional>

namespace clearway {

/// Provides the requested number of oneTBB threads during its lifetime, even more than the machine
/// has cores. A lower limit that the caller has set is not exceeded.
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads) {
    constexpr auto kLimit = tbb::global_control::max_allowed_parallelism;
    const auto wanted = static_cast<std::size_t>(threads);
    if (wanted > tbb::global_control::active_value(kLimit)) raised_.emplace(kLimit, wanted);
    allowed_ = static_cast<int>(std::min(wanted, tbb::global_control::active_value(kLimit)));
  }

  /// Calls body() in an arena of the threads provided, and returns what it returns.
  template <typename Body>
  auto run(const Body& body) const {
    return tbb::task_arena(allowed_).execute(body);
  }

 private:
  std::optional<tbb::global_control> raised_;
  int allowed_;
};

}  // namespace clearway
