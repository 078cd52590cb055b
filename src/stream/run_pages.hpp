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

/// Takes what was found in a page of these cells. Several threads call it at once, each with
/// another page.
using CollectPage = std::function<void(std::span<const PlannedCell>, const PageResult&)>;

/// What run_pages() has to know besides the pages and engines.
struct PageRun {
  const char* stage = "search";  ///< name of the stage for those who watch the progress
  const IgnoredPoints& ignored;  ///< decides which points of the pages are searched
  int threads = 0;               ///< 0: all cores
};

/// Runs the pages for callers that keep the results themselves: `collect` takes the result of each
/// page. Returns how many points of the pages were not searched.
std::uint64_t run_pages(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                        std::span<const PlannedPage> pages, std::span<PageEngine* const> engines,
                        const PageRun& run, const CollectPage& collect, Progress& progress,
                        StageTimes& times);

/// Runs pages through engines and returns the answer. Pages are staged in their order into
/// whichever slot of an engine is free, searched, and their answers collected. threads: 0 for all
/// cores. For each engine at most one thread waits for a device, or one for each slot if its pages
/// are not alike. Progress counts points. An exception of any stage ends the run: no further page
/// is started, those under way are finished, then it is rethrown; the same happens, with
/// Interrupted, when the progress asks to stop. The pages must fit the slots of every engine. The
/// journal, if there is one, keeps the answer of every page, and what it held before becomes part
/// of the answer.
SearchResult run_pages(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                       std::span<const PlannedPage> pages, std::span<PageEngine* const> engines,
                       const Query& query, int threads, Progress& progress, StageTimes& times,
                       SearchJournal* journal = nullptr);

/// Memory that run_pages() takes in addition to the engine and the answer, bytes.
std::uint64_t run_pages_bytes(std::size_t pages);

}  // namespace clearway
