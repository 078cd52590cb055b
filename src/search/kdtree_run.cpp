#include "search/kdtree_run.hpp"

#include <algorithm>

#include "core/util/stopwatch.hpp"
#include "cpu/kdtree_engine.hpp"
#include "search/memory_budget.hpp"
#include "stream/write_result.hpp"

namespace clearway {

SearchResult run_kdtree_engine(const StoreReader& store, const Query& query,
                               const EngineOptions& options, SearchJournal& journal,
                               Progress& progress, EngineReport& report) {
  const std::uint64_t kept = program_bytes(options.threads) + input_bytes(store, query) +
                             SearchJournal::most_bytes(store, query, options.threads);
  report.needed_bytes = kept + std::max(kdtree_memory_bytes(store, query, options.threads),
                                        result_bytes(store, query) + least_write_bytes());
  check_memory(report.needed_bytes, options.memory_bytes);
  report.write_bytes = options.memory_bytes - kept - result_bytes(store, query);
  const Stopwatch compute;
  HitSet hits =
      run_kdtree(store, query, {.threads = options.threads, .journal = &journal}, progress);
  report.stages.compute = report.stages.total = compute.seconds();
  return {std::move(hits), ClearanceSet()};
}

}  // namespace clearway
