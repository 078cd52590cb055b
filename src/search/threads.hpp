#pragma once

#include <tbb/task_arena.h>

#include "io/files/thread_limit.hpp"

namespace clearway {

/// Throws ResourceError where this process cannot have that many threads. OpenMP would end the
/// program instead.
void check_threads(int threads);

/// The number of threads, or of cores where it is 0.
inline int threads_or_all(int threads) {
  return threads != 0 ? threads : tbb::this_task_arena::max_concurrency();
}

/// Calls body() with at most this many threads of oneTBB, or as many as there are cores for 0, and
/// returns what it returns. Throws as check_threads() does.
template <typename Body>
auto in_threads(int threads, const Body& body) {
  threads = threads_or_all(threads);
  check_threads(threads);
  return ThreadLimit(threads).run(body);
}

}  // namespace clearway
