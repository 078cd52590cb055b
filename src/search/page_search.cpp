#include "search/page_search.hpp"

#include <algorithm>
#include <optional>
#include <vector>

#include "core/util/format.hpp"
#include "core/util/stopwatch.hpp"
#include "cpu/kdtree_engine.hpp"
#include "search/memory_budget.hpp"
#include "stream/plan.hpp"
#include "stream/run_pages.hpp"
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
         std::max(kdtree_memory_bytes(store, query, options.threads) + further_bytes(store, query),
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
  return {{.hits = std::move(hits),
           .clearances = ClearanceSet(),
           .ignored_points = counted.ignored_points},
          options.memory_bytes - kept - result};
}

namespace {

void report_plan(const PageBudget& budget, const PageEngineKind& kind, SearchReport& report,
                 const MessageLog& log) {
  report.seconds.plan = budget.plan_seconds();
  report.seconds.field = budget.index_seconds();
  report.needed_host_bytes = budget.needed_bytes();
  report.page_bytes = budget.layout().page_bytes;
  kind.log_index(log);
}

void report_stages(const StageTimes& stages, SearchSeconds& seconds) {
  seconds.read = stages.read;
  seconds.upload = stages.upload;
  seconds.compute = stages.compute;
  seconds.collect = stages.collect;
  seconds.search = stages.total;
}

/// The threads that pay: fewer than the kind has where there is little to search on the CPU,
/// because to wake another thread takes as long as a few thousand points.
int useful_threads(const PackedCloud& cloud, const Query& query, std::span<const PlannedCell> cells,
                   const PageEngineNeeds& needs) {
  constexpr std::uint64_t kPointsOfThread = std::uint64_t{1} << 14, kMostPoses = 64;
  if (needs.on_gpu) return needs.threads;
  std::uint64_t points = 0;
  for (const PlannedCell& cell : cells) points += cloud.cells()[cell.cell].count;
  const std::uint64_t poses = std::clamp<std::uint64_t>(query.poses.size(), 1, kMostPoses);
  return static_cast<int>(std::clamp<std::uint64_t>(points * poses / kPointsOfThread, 1,
                                                    static_cast<std::uint64_t>(needs.threads)));
}

/// Begins to take the engines down, and waits until that is done where memory is too scarce to
/// write the result at the same time.
Found ended(const StoreReader& store, const PageEngineKind& kind, PageEngines engines, Found found,
            std::uint64_t pinned_bytes) {
  found.engine_end = kind.end(std::move(engines));
  if (found.write_bytes / 2 >= pinned_bytes + least_write_bytes(store)) {
    found.write_bytes -= pinned_bytes;
  } else {
    found.engine_end.clear();
  }
  return found;
}

}  // namespace

Found search_pages(const StoreReader& store, const Query& query, std::uint64_t memory_bytes,
                   PageEngineKind& kind, const ShardCells* only, const SearchSteps& steps,
                   Progress& progress, SearchReport& report, const MessageLog& log) {
  throw_if_stopped(progress);
  PageBudget budget(store, query, memory_bytes, kind, only, least_write_bytes(store));
  budget.find();
  report_plan(budget, kind, report, log);

  throw_if_stopped(progress);
  if (steps.planned) steps.planned(budget.needed_bytes(), kind.own_device_bytes(budget.layout()));
  const Stopwatch making;
  PageEngines engines = kind.make(budget.layout());
  report.seconds.engine = making.seconds();
  SearchJournal* const journal = steps.open_journal ? steps.open_journal() : nullptr;
  std::vector<PlannedCell>& cells = budget.cells();
  if (journal != nullptr) {
    std::erase_if(cells,
                  [&](const PlannedCell& cell) { return journal->cell_finished(cell.cell); });
  }
  const std::vector<PlannedPage> pages = paginate(store, cells, budget.layout().page_bytes,
                                                  budget.layout().cells, query.ignores_points());
  report.pages = pages.size();
  std::vector<PageEngine*> lanes;
  for (const auto& engine : engines) {
    report.slots += engine->slots();
    lanes.push_back(engine.get());
  }
  StageTimes stages;
  const int threads = useful_threads(store, query, cells, kind.needs());
  SearchResult result =
      run_pages(store, cells, pages, lanes, query, threads, progress, stages, journal);
  report_stages(stages, report.seconds);
  kind.report_search({lanes.data(), lanes.size()}, report, log);
  return ended(store, kind, std::move(engines), {std::move(result), budget.write_bytes()},
               report.pinned_bytes);
}

CollectedPages collect_pages(const PackedCloud& cloud, const Query& query,
                             std::uint64_t memory_bytes, PageEngineKind& kind,
                             const ShardCells* only, IgnoredPoints::Search search,
                             const char* stage, const CollectPage& collect, Progress& progress) {
  PageBudget budget(cloud, query, memory_bytes, kind, only, std::nullopt, search);
  budget.find();
  throw_if_stopped(progress);
  PageEngines engines = kind.make(budget.layout());
  const std::vector<PlannedPage> pages = paginate(cloud, budget.cells(), budget.layout().page_bytes,
                                                  budget.layout().cells, query.ignores_points());
  std::vector<PageEngine*> lanes;
  for (const auto& engine : engines) lanes.push_back(engine.get());
  StageTimes times;
  run_pages(cloud, budget.cells(), pages, lanes,
            {.stage = stage, .ignored = budget.ignored(), .threads = kind.needs().threads}, collect,
            progress, times);
  SearchReport taken;
  const MessageCallback silent;
  std::vector<Message> none;
  kind.report_search({lanes.data(), lanes.size()}, taken, MessageLog(silent, none));
  kind.end(std::move(engines)).clear();
  return {budget.needed_bytes(), taken.peak_device_bytes};
}

}  // namespace clearway
