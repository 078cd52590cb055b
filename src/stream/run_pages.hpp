#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "clearway/query.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "core/page/page_engine.hpp"
#include "core/query/ignored_points.hpp"
#include "core/query/search_result.hpp"
#include "core/util/progress.hpp"
#include "stream/plan.hpp"

namespace clearway {

/// The entry of a point of a page; `cells` are the page's cells.
std::uint64_t entry_of(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                       std::uint32_t point);

/// Offers the nearest points that were found in a page of these cells. Throws InputError if the
/// source index of such a point cannot be read.
void offer_profile(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                   std::span<const ProfileFact> facts, ProfileSet& profile);

/// Where the coordinates of a cell are kept outside of a page, as PageEngine::kept() says it.
using KeptPayload = std::function<std::optional<CellPayload>(std::uint32_t cell)>;

/// Fills `page` with the cells from the cloud: headers, motion nodes, block boxes, masks, and
/// packed coordinates, which are read straight into it unless they are kept elsewhere. page:
/// aligned to kPageAlignment, and at least as large as the page of these cells. masks: those that
/// are ignored; null for a page without masks. Thread safe. Throws what reading the cells throws.
PageShape stage_page(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                     std::span<std::byte> page, const IgnoredPoints* masks = nullptr,
                     const KeptPayload& kept = nullptr);

/// The times at which the stages of one page ran.
struct PageTimes {
  Interval read{}, upload{}, compute{}, collect{};
};

/// Wall-clock seconds in which at least one worker of a stage was busy.
struct StageTimes {
  double read = 0;  ///< including staging and checking
  double upload = 0;
  double compute = 0;
  double collect = 0;
  double total = 0;  ///< seconds from the first page to the last one
};

/// Length of the union of the intervals, seconds. An interval that does not end after it begins has
/// no length.
double busy_seconds(std::vector<Interval> intervals);

StageTimes stage_times(const std::vector<PageTimes>& pages);

/// Takes what was found in a page of these cells. Several threads call it at once, each with
/// another page.
using CollectPage = std::function<void(std::span<const PlannedCell>, const PageResult&)>;

/// What run_pages() has to know besides the pages and engines.
struct PageRun {
  const char* stage = "search";  ///< name of the stage for those who watch the progress
  /// Decides which points of the pages are searched; null: all are, and pages have no masks
  const IgnoredPoints* masks = nullptr;
  int threads = 0;  ///< 0: all cores
};

/// Runs pages through engines. Pages are staged in their order into whichever slot of an engine is
/// free, and searched, and `collect` takes the result of each. For each engine at most one thread
/// waits for a device, or one for each slot if its pages are not alike. Progress counts points. An
/// exception of any stage ends the run: no further page is started, those under way are finished,
/// then it is rethrown; the same happens, with Interrupted, when the progress asks to stop. The
/// pages must fit the slots of every engine.
void run_pages(const PackedCloud& cloud, std::span<const PlannedCell> cells,
               std::span<const PlannedPage> pages, std::span<PageEngine* const> engines,
               const PageRun& run, const CollectPage& collect, Progress& progress,
               StageTimes& times);

/// Memory that run_pages() takes in addition to the engine, bytes.
std::uint64_t run_pages_bytes(std::size_t pages);

}  // namespace clearway
