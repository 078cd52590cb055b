#include "bench/experiments/thread_counts.hpp"
#include "support/catch.hpp"

using namespace clearway::bench;

TEST_CASE("one thread, all cores and twice as many are measured on every machine") {
  for (int cores = 1; cores <= 300; ++cores) {
    CAPTURE(cores);
    const std::set<int> counts = thread_counts(cores);
    for (const int threads : {1, cores, 2 * cores}) CHECK(counts.contains(threads));
    CHECK(*counts.begin() == 1);
    CHECK(*counts.rbegin() == 2 * cores);
    CHECK(counts.size() <= 34);
  }
  CHECK(thread_counts(2) == std::set<int>{1, 2, 3, 4});
  CHECK(thread_counts(16) ==
        std::set<int>{1, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30, 32});
}
