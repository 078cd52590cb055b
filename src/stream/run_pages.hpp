#pragma once

#include <functional>
#include <span>

#include "clearway/query.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "core/page/page_engine.hpp"
#include "core/query/ignored_points.hpp"
#include "core/query/search_result.hpp"
#include "core/util/progress.hpp"
#include "stream/paginate.hpp"
#include "stream/search_journal.hpp"
#include "stream/stage_times.hpp"

namespace clearway {

/// What becomes of what was found in a page of these cells. Called by several threads at once, each
/// with another page.
using CollectPage = std::function<void(std::span<const PlannedCell>, const PageResult&)>;

/// What run_pages() is to do beside the pages and engines.
struct PageRun {
  const char* stage = "search";  ///< its name for those who watch the progress
  const IgnoredPoints& ignored;  ///< says which points of the pages are searched
  int threads = 0;               ///< 0: all
};

/// As below, for callers that keep what is found themselves. Returns how many points of the pages
/// were not searched.
std::uint64_t run_pages(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                        std::span<const PlannedPage> pages, std::span<PageEngine* const> engines,
                        const PageRun& run, const CollectPage& collect, Progress& progress,
                        StageTimes& times);

/// Stages the pages in their order into whichever slot of an engine is free, has them searched and
/// collects the answers, with `threads` (0: all); for each engine, one of them at the most waits
/// for a device, or one a slot where its pages are not alike. Progress counts points. What a stage
/// throws ends the run: no page is started any more, those under way are finished, then it is
/// thrown on; likewise, with Interrupted, when the progress asks to stop. The pages fit the slots
/// of every engine. The journal, where there is one, keeps the answer of every page; what it held
/// before is part of the answer.
SearchResult run_pages(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                       std::span<const PlannedPage> pages, std::span<PageEngine* const> engines,
                       const Query& query, int threads, Progress& progress, StageTimes& times,
                       SearchJournal* journal = nullptr);

/// Memory that run_pages takes beside the engine and the answer, bytes.
std::uint64_t run_pages_bytes(std::size_t pages);

}  // namespace clearway
