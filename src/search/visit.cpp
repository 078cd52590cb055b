#include "search/visit.hpp"

#include <algorithm>
#include <optional>
#include <vector>

#include "core/util/format.hpp"
#include "core/util/stopwatch.hpp"
#include "search/memory_budget.hpp"
#include "stream/plan.hpp"
#include "stream/run_pages.hpp"

namespace clearway {

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

/// Runs the planned cells that are not answered yet.
void run_planned(const PackedCloud& cloud, const Visit& visit, PageBudget& budget,
                 std::span<PageEngine* const> engines, Progress& progress, SearchReport& report) {
  std::vector<PlannedCell>& cells = budget.cells();
  if (visit.answered) {
    std::erase_if(cells, [&](const PlannedCell& cell) { return visit.answered(cell.cell); });
  }
  const std::vector<PlannedPage> pages = paginate(cloud, cells, budget.layout().page_bytes,
                                                  budget.layout().cells, budget.masks() != nullptr);
  report.pages = pages.size();
  for (const PageEngine* engine : engines) report.slots += engine->slots();
  StageTimes stages;
  run_pages(cloud, cells, pages, engines,
            {.stage = visit.stage,
             .masks = budget.masks(),
             .threads = useful_threads(cloud, visit.query, cells, visit.kind.needs())},
            visit.collect, progress, stages);
  report_stages(stages, report.seconds);
}

}  // namespace

VisitEnd run_visit(const PackedCloud& cloud, const Visit& visit, Progress& progress,
                   SearchReport& report, const MessageLog& log) {
  throw_if_stopped(progress);
  PageEngineKind& kind = visit.kind;
  PageBudget budget(cloud, visit.query, visit.memory_bytes, kind, visit.only,
                    visit.least_write_bytes, visit.search);
  budget.find();
  report_plan(budget, kind, report, log);

  throw_if_stopped(progress);
  if (visit.planned) visit.planned(budget.needed_bytes(), kind.own_device_bytes(budget.layout()));
  const Stopwatch making;
  PageEngines engines = kind.make(budget.layout());
  report.seconds.engine = making.seconds();
  if (visit.made) visit.made();
  std::vector<PageEngine*> lanes;
  for (const auto& engine : engines) lanes.push_back(engine.get());
  run_planned(cloud, visit, budget, lanes, progress, report);
  VisitEnd end{.write_bytes = budget.write_bytes()};
  kind.report_search({lanes.data(), lanes.size()}, report, log);
  end.engine_end = kind.end(std::move(engines));
  // The engines are taken down while the result is written, unless memory is too scarce for both.
  if (end.write_bytes / 2 >= report.pinned_bytes + visit.least_write_bytes.value_or(0)) {
    end.write_bytes -= report.pinned_bytes;
  } else {
    end.engine_end.clear();
  }
  return end;
}

SearchReport run_visit(const PackedCloud& cloud, const Visit& visit, Progress& progress) {
  SearchReport report;
  const MessageCallback silent;
  run_visit(cloud, visit, progress, report, MessageLog(silent, report.warnings)).engine_end.clear();
  return report;
}

}  // namespace clearway
