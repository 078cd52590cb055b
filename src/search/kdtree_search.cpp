#include "search/kdtree_search.hpp"

#include <algorithm>

#include "core/util/stopwatch.hpp"
#include "cpu/kdtree_engine.hpp"
#include "search/memory_budget.hpp"
#include "stream/write_result.hpp"

namespace clearway {

Found search_kdtree(const StoreReader& store, const Query& query, const SearchOptions& options,
                    SearchJournal& journal, Progress& progress, SearchReport& report) {
  const std::uint64_t result = search_result_bytes(store, query);
  const std::uint64_t kept = program_bytes(options.threads) + input_bytes(store, query) +
                             SearchJournal::most_bytes(store, query, options.threads);
  report.needed_host_bytes = kept + std::max(kdtree_memory_bytes(store, query, options.threads),
                                             result + least_write_bytes());
  check_memory(report.needed_host_bytes, options.memory_bytes);
  const Stopwatch compute;
  HitSet hits =
      run_kdtree(store, query, {.threads = options.threads, .journal = &journal}, progress);
  report.seconds.compute = report.seconds.search = compute.seconds();
  return {{std::move(hits), ClearanceSet()}, options.memory_bytes - kept - result};
}

}  // namespace clearway
