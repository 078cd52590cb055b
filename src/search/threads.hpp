#pragma once

#include <tbb/task_arena.h>

#include "io/system/thread_limit.hpp"

namespace clearway {

/// Throws ResourceError where this process may not have that many threads. OpenMP would end the
/// program instead.
void check_threads(int threads);

/// threads: 0 for as many as there are cores.
inline int threads_or_all(int threads) {
  return threads != 0 ? threads : tbb::this_task_arena::max_concurrency();
}

/// Calls body() where oneTBB has that many threads; 0: as many as there are cores. Throws as
/// check_threads does.
template <typename Body>
auto in_threads(int threads, const Body& body) {
  threads = threads_or_all(threads);
  check_threads(threads);
  return ThreadLimit(threads).run(body);
}

}  // namespace clearway
