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
#include "stream/search_journal.hpp"
#include "stream/write_result.hpp"

namespace clearway {

namespace {

/// Bytes that are kept to the end of the run, besides what is found.
std::uint64_t kept_by_kdtree(const StoreReader& store, const Query& query, int threads) {
  return program_bytes(threads) + input_bytes(store, query) +
         SearchJournal::most_bytes(store, query, threads) + search_result_bytes(store, query);
}

/// Adds the colliding points of all cells that have any and are not known yet.
void add_hits(const StoreReader& store, const HitSet& hits, AnswerRows& rows) {
  for (std::uint32_t cell = 0; cell < store.cells().size(); ++cell) {
    if (rows.answered(cell, PointQuestion::kHits)) continue;
    const std::uint64_t first = std::uint64_t{cell} * store.blocks_per_cell();
    CellRows found;
    for (std::uint64_t block = 0; block < store.blocks_per_cell(); ++block) {
      found.words.push_back(hits.word(first + block));
    }
    if (found.count() == 0) continue;
    if (hits.has_first_pose()) {
      found.for_each([&](std::uint32_t point, std::size_t) {
        found.poses.push_back(hits.first_pose(first * kBlockPoints + point));
      });
    }
    rows.add(cell, {{PointQuestion::kHits, found}});
  }
}

}  // namespace

std::uint64_t kdtree_needed_bytes(const StoreReader& store, const Query& query,
                                  const SearchOptions& options) {
  return kept_by_kdtree(store, query, options.threads) +
         std::max(kdtree_memory_bytes(store, query, options.threads),
                  least_write_bytes(store, query));
}

SearchEnd search_kdtree(const StoreReader& store, const Query& query, const ShardCells* only,
                        const SearchOptions& options, PoseJournal* journal, AnswerRows& rows,
                        Progress& progress, SearchReport& report) {
  report.needed_host_bytes = kdtree_needed_bytes(store, query, options);
  check_memory(report.needed_host_bytes, options.memory_bytes);
  const Stopwatch compute;
  KdTreeOptions how{.threads = options.threads, .journal = journal};
  if (only != nullptr) how.only = [only](std::uint32_t cell) { return only->contains(cell); };
  KdTreeStatistics counted;
  const HitSet hits = run_kdtree(store, query, how, progress, &counted);
  add_hits(store, hits, rows);
  report.seconds.compute = report.seconds.search = compute.seconds();
  return {.ignored_points = counted.ignored_points,
          .write_bytes = options.memory_bytes - kept_by_kdtree(store, query, options.threads)};
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

/// Runs the planned cells that are not answered yet. Returns how many points of them were not
/// searched.
std::uint64_t run_planned(const PackedCloud& cloud, const PageSearch& asked, PageBudget& budget,
                          std::span<PageEngine* const> engines, Progress& progress,
                          SearchReport& report) {
  std::vector<PlannedCell>& cells = budget.cells();
  if (asked.answered) {
    std::erase_if(cells, [&](const PlannedCell& cell) { return asked.answered(cell.cell); });
  }
  const std::vector<PlannedPage> pages =
      paginate(cloud, cells, budget.layout().page_bytes, budget.layout().cells,
               asked.query.ignores_points());
  report.pages = pages.size();
  for (const PageEngine* engine : engines) report.slots += engine->slots();
  StageTimes stages;
  const std::uint64_t ignored =
      run_pages(cloud, cells, pages, engines,
                {.stage = asked.stage,
                 .ignored = budget.ignored(),
                 .threads = useful_threads(cloud, asked.query, cells, asked.kind.needs())},
                asked.collect, progress, stages);
  report_stages(stages, report.seconds);
  return ignored;
}

std::vector<PageEngine*> lanes_of(const PageEngines& engines) {
  std::vector<PageEngine*> lanes;
  for (const auto& engine : engines) lanes.push_back(engine.get());
  return lanes;
}

}  // namespace

SearchEnd search_pages(const StoreReader& store, const PageSearch& asked, const SearchSteps& steps,
                       Progress& progress, SearchReport& report, const MessageLog& log) {
  throw_if_stopped(progress);
  const std::uint64_t least = least_write_bytes(store, asked.query);
  PageEngineKind& kind = asked.kind;
  PageBudget budget(store, asked.query, asked.memory_bytes, kind, asked.only, least, asked.search);
  budget.find();
  report_plan(budget, kind, report, log);

  throw_if_stopped(progress);
  if (steps.planned) steps.planned(budget.needed_bytes(), kind.own_device_bytes(budget.layout()));
  const Stopwatch making;
  PageEngines engines = kind.make(budget.layout());
  report.seconds.engine = making.seconds();
  if (steps.made) steps.made();
  const std::vector<PageEngine*> lanes = lanes_of(engines);
  SearchEnd end{.ignored_points = run_planned(store, asked, budget, lanes, progress, report),
                .write_bytes = budget.write_bytes()};
  kind.report_search({lanes.data(), lanes.size()}, report, log);
  end.engine_end = kind.end(std::move(engines));
  // The engines are taken down while the result is written, unless memory is too scarce for both.
  if (end.write_bytes / 2 >= report.pinned_bytes + least) {
    end.write_bytes -= report.pinned_bytes;
  } else {
    end.engine_end.clear();
  }
  return end;
}

CollectedPages collect_pages(const PackedCloud& cloud, const PageSearch& asked,
                             Progress& progress) {
  PageEngineKind& kind = asked.kind;
  PageBudget budget(cloud, asked.query, asked.memory_bytes, kind, asked.only, std::nullopt,
                    asked.search);
  budget.find();
  throw_if_stopped(progress);
  PageEngines engines = kind.make(budget.layout());
  const std::vector<PageEngine*> lanes = lanes_of(engines);
  SearchReport taken;
  run_planned(cloud, asked, budget, lanes, progress, taken);
  const MessageCallback silent;
  std::vector<Message> none;
  kind.report_search({lanes.data(), lanes.size()}, taken, MessageLog(silent, none));
  kind.end(std::move(engines)).clear();
  return {budget.needed_bytes(), taken.peak_device_bytes};
}

}  // namespace clearway
