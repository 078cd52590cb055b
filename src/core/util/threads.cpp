#include "core/util/threads.hpp"

#include <latch>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "clearway/error.hpp"

namespace clearway {

void check_threads(int threads) {
  std::latch all_started(1);
  std::vector<std::jthread> started;
  try {
    for (int i = 1; i < threads; ++i) started.emplace_back([&] { all_started.wait(); });
  } catch (const std::system_error& error) {
    all_started.count_down();
    refuse_threads(threads, error.what());
  }
  all_started.count_down();
}

void refuse_threads(int threads, const char* reason) {
  throw ResourceError(std::to_string(threads) + " threads cannot be started (" + reason +
                          "): the limit of processes or memory is reached",
                      Remedy::kFewerThreads);
}

}  // namespace clearway
