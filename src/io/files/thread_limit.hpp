#pragma once

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <optional>

#include "core/util/threads.hpp"

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

/// The number of threads, or of those that this arena of oneTBB may have where it is 0.
inline int threads_or_all(int threads) {
  return threads != 0 ? threads : tbb::this_task_arena::max_concurrency();
}

/// Calls body(), which uses the threads that this arena of oneTBB may have. An arena of its own,
/// as in_threads() makes, would cost oneTBB 14 KB that it gives back late. Throws as
/// check_threads() does.
template <typename Body>
auto in_all_threads(const Body& body) {
  check_threads(threads_or_all(0));
  return body();
}

/// Calls body() with at most this many threads of oneTBB, or as many as threads_or_all(0) says for
/// 0, and returns what it returns. Throws as check_threads() does.
template <typename Body>
auto in_threads(int threads, const Body& body) {
  threads = threads_or_all(threads);
  check_threads(threads);
  return ThreadLimit(threads).run(body);
}

}  // namespace clearway
