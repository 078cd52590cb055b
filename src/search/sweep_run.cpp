#include "search/sweep_run.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>

#include "core/util/format.hpp"
#include "cpu/sweep_engine.hpp"

namespace clearway {
namespace {

/// Beside those that are searched: pages that are read meanwhile.
constexpr std::uint32_t kSlotsAhead = 2;

}  // namespace

void report_statistics(const SweepStatistics& s, EngineReport& report) {
  spdlog::info("tests: {} of boxes, {} of points ({} points), {} exact", format_count(s.node_tests),
               format_count(s.point_tests), format_count(s.points_tested),
               format_count(s.exact_tests));
  if (report.tolerance) {
    report.tolerance->resolved_by_bounds = s.resolved_tests;
    spdlog::info("tolerance: {} exact tests spared by bounds", format_count(s.resolved_tests));
  }
}

PageEngineKind cpu_sweep(const StoreReader& store, const Query& query,
                         const EngineOptions& options) {
  const auto threads = static_cast<std::uint32_t>(options.threads);
  PageEngineKind kind;
  kind.most_slots = threads + kSlotsAhead;
  kind.threads = options.threads;
  kind.host_bytes = [&store, &query, threads](const SearchPlan& plan, const SlotLayout& layout) {
    return layout.slots * PagePool::slot_bytes(store, query, layout) +
           std::min(layout.slots, threads) *
               CellSearch::most_bytes(store, query, plan.most_poses());
  };
  kind.make = [&store](const SearchPlan& plan, const SlotLayout& layout) {
    PageEngines engines;
    engines.push_back(std::make_unique<SweepEngine>(store, plan.filter, layout));
    return engines;
  };
  kind.finished = [](const SearchPlan&, const PageEngines& engines, EngineReport& report) {
    report_statistics(dynamic_cast<const SweepEngine&>(*engines.front()).statistics(), report);
  };
  return kind;
}

}  // namespace clearway
