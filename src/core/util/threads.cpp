#include "core/util/threads.hpp"

#include <algorithm>
#include <atomic>
#include <latch>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "clearway/error.hpp"

namespace clearway {

void check_threads(int threads) {
  // oneTBB and OpenMP keep the threads that they have started, so a number that was to be had once
  // need not be tried again. Readers of files ask for it at each read.
  static std::atomic<int> most_started{1};
  if (threads <= most_started) return;
  std::latch all_started(1);
  std::vector<std::jthread> started;
  // The pools of oneTBB and OpenMP live beside each other, and so do a few threads of other work,
  // which goes on without one but may take the place of one of a pool.
  constexpr int kPools = 2, kOthers = 2;
  const int needed = kPools * (threads - 1) + kOthers;
  try {
    for (int i = 0; i < needed; ++i) started.emplace_back([&] { all_started.wait(); });
  } catch (const std::system_error& error) {
    all_started.count_down();
    refuse_threads(threads, error.what());
  }
  all_started.count_down();
  most_started = std::max(most_started.load(), threads);
}

void refuse_threads(int threads, const char* reason) {
  throw ResourceError(std::to_string(threads) + " threads cannot be started (" + reason +
                          "): the limit of processes or memory is reached",
                      Remedy::kFewerThreads);
}

}  // namespace clearway
