#pragma once

#include <cstdint>
#include <functional>

#include "core/query/ignored_points.hpp"
#include "core/query/search_result.hpp"
#include "core/util/progress.hpp"
#include "io/store/store_reader.hpp"
#include "search/kinds/page_engine_kind.hpp"
#include "search/shard_cells.hpp"
#include "stream/run_pages.hpp"
#include "stream/search_journal.hpp"

namespace clearway {

/// What a search found, and the bytes of memory that are left to write it with while its engines
/// are still being taken down.
struct Found {
  SearchResult result;
  std::uint64_t write_bytes = 0;
  EngineEnd engine_end = {};
};

/// What search_pages() asks its caller for; either may be empty.
struct SearchSteps {
  /// Called with the bytes that the search takes, on the host and on each device, once it is
  /// planned.
  std::function<void(std::uint64_t host, std::uint64_t device)> planned = {};
  /// Returns the journal, or null; called once the engines are made.
  std::function<SearchJournal*()> open_journal = {};
};

/// Plans the query, or those of its cells that `only` contains, within memory_bytes, makes the
/// engines, and searches the cells that the journal does not have. Throws ResourceError naming the
/// smallest budget that works, before the journal is asked for.
Found search_pages(const StoreReader& store, const Query& query, std::uint64_t memory_bytes,
                   PageEngineKind& kind, const ShardCells* only, const SearchSteps& steps,
                   Progress& progress, SearchReport& report, const MessageLog& log);

/// What a search that hands its pages to the caller took.
struct CollectedPages {
  std::uint64_t needed_host_bytes = 0, peak_device_bytes = 0;
};

/// Searches the cells of a cloud, or those that `only` contains, and hands the result of each page
/// to `collect`, so that no answer is kept. search: which points are searched; stage: the name for
/// those who watch the progress. Throws ResourceError as search_pages() does.
CollectedPages collect_pages(const PackedCloud& cloud, const Query& query,
                             std::uint64_t memory_bytes, PageEngineKind& kind,
                             const ShardCells* only, IgnoredPoints::Search search,
                             const char* stage, const CollectPage& collect, Progress& progress);

/// The most bytes that a search with engine kdtree takes, besides the mapped store. options.threads
/// is not 0.
std::uint64_t kdtree_needed_bytes(const StoreReader& store, const Query& query,
                                  const SearchOptions& options);

/// Searches all cells, or those of `only`, with engine kdtree. options.threads is not 0. Throws
/// ResourceError where the memory is too little.
Found search_kdtree(const StoreReader& store, const Query& query, const ShardCells* only,
                    const SearchOptions& options, SearchJournal* journal, Progress& progress,
                    SearchReport& report);

}  // namespace clearway
