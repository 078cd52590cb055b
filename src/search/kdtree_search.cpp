#include "search/kdtree_search.hpp"

#include <algorithm>

#include "core/util/stopwatch.hpp"
#include "cpu/kdtree_engine.hpp"
#include "search/memory_budget.hpp"
#include "stream/write_result.hpp"

namespace clearway {

namespace {

/// Bytes that are kept to the end of the run, besides what is found.
std::uint64_t kept_by_kdtree(const StoreReader& store, const Query& query, int threads) {
  return program_bytes(threads) + input_bytes(store, query) +
         SearchJournal::most_bytes(store, query, threads);
}

}  // namespace

std::uint64_t kdtree_needed_bytes(const StoreReader& store, const Query& query,
                                  const SearchOptions& options) {
  return kept_by_kdtree(store, query, options.threads) +
         std::max(
             kdtree_memory_bytes(store, query, options.threads) + last_pose_bytes(store, query),
             search_result_bytes(store, query) + least_write_bytes(store));
}

Found search_kdtree(const StoreReader& store, const Query& query, const ShardCells* only,
                    const SearchOptions& options, SearchJournal* journal, Progress& progress,
                    SearchReport& report) {
  const std::uint64_t result = search_result_bytes(store, query);
  const std::uint64_t kept = kept_by_kdtree(store, query, options.threads);
  report.needed_host_bytes = kdtree_needed_bytes(store, query, options);
  check_memory(report.needed_host_bytes, options.memory_bytes);
  const Stopwatch compute;
  KdTreeOptions how{.threads = options.threads, .journal = journal};
  if (only != nullptr) how.only = [only](std::uint32_t cell) { return only->contains(cell); };
  KdTreeStatistics counted;
  HitSet hits = run_kdtree(store, query, how, progress, &counted);
  report.seconds.compute = report.seconds.search = compute.seconds();
  return {{std::move(hits), ClearanceSet(), {}, counted.ignored_points},
          options.memory_bytes - kept - result};
}

}  // namespace clearway
