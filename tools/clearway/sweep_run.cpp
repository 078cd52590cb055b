#include "clearway/sweep_run.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>

#include "clearway/options.hpp"
#include "cpu/sweep_engine.hpp"

namespace clearway::tool {
namespace {

/// Beside those that are searched: pages that are read meanwhile.
constexpr std::uint32_t kSlotsAhead = 2;

}  // namespace

void report_statistics(const SweepStatistics& s, EngineReport& report) {
  spdlog::info("tests: {} of boxes, {} of points ({} points), {} exact", format_count(s.node_tests),
               format_count(s.point_tests), format_count(s.points_tested),
               format_count(s.exact_tests));
  if (report.tolerance) {
    report.tolerance->settled_by_bounds = s.settled_tests;
    spdlog::info("tolerance: {} exact tests spared by bounds", format_count(s.settled_tests));
  }
}

PageEngineKind cpu_sweep(const Store& store, const Question& question,
                         const EngineOptions& options) {
  const auto threads = static_cast<std::uint32_t>(options.threads);
  PageEngineKind kind;
  kind.most_slots = threads + kSlotsAhead;
  kind.threads = options.threads;
  kind.host_bytes = [&store, &question, threads](const SearchPlan& plan, const SlotLayout& layout) {
    return layout.slots * PagePool::slot_bytes(store, question, layout) +
           std::min(layout.slots, threads) *
               CellSearch::most_bytes(store, question, plan.most_poses());
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

}  // namespace clearway::tool
