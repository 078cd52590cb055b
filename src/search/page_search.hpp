#pragma once

#include <cstdint>
#include <functional>

#include "core/query/ignored_points.hpp"
#include "core/util/progress.hpp"
#include "io/store/store_reader.hpp"
#include "search/kinds/page_engine_kind.hpp"
#include "search/shard_cells.hpp"
#include "stream/answer_rows.hpp"
#include "stream/run_pages.hpp"

namespace clearway {

/// A search on pages, and where its results go. All references outlive it.
struct PageSearch {
  const Query& query;
  std::uint64_t memory_bytes;
  PageEngineKind& kind;
  /// The cells to search; null for all
  const ShardCells* only = nullptr;
  /// Takes the result of each page.
  CollectPage collect;
  /// Whether a cell was searched before; null where none was
  std::function<bool(std::uint32_t)> answered = nullptr;
  const char* stage = "search";  ///< the name for those who watch the progress
  IgnoredPoints::Search search = IgnoredPoints::Search::kOthers;
};

/// What search_pages() asks its caller for; either may be empty.
struct SearchSteps {
  /// Called with the bytes that the search takes, on the host and on each device, once it is
  /// planned.
  std::function<void(std::uint64_t host, std::uint64_t device)> planned = {};
  /// Called once the engines are made.
  std::function<void()> made = {};
};

/// What a search leaves when it is done.
struct SearchEnd {
  std::uint64_t ignored_points = 0;  ///< number of ignored points in the cells that were searched
  /// The bytes of memory that are left to write with while engines are still being taken down
  std::uint64_t write_bytes = 0;
  EngineEnd engine_end = {};
};

/// Plans a search whose answer is kept and written, makes the engines, and searches. Throws
/// ResourceError naming the smallest budget that works, before the engines are made.
SearchEnd search_pages(const StoreReader& store, const PageSearch& asked, const SearchSteps& steps,
                       Progress& progress, SearchReport& report, const MessageLog& log);

/// What a search that hands its pages to the caller took.
struct CollectedPages {
  std::uint64_t needed_host_bytes = 0, peak_device_bytes = 0;
};

/// Searches for a caller that keeps nothing of the answer by cells. Throws ResourceError as
/// search_pages() does.
CollectedPages collect_pages(const PackedCloud& cloud, const PageSearch& asked, Progress& progress);

}  // namespace clearway
