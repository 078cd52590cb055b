#include "search/grid_run.hpp"

#include <spdlog/spdlog.h>

#include "core/util/format.hpp"
#include "cpu/grid_cpu_engine.hpp"

namespace clearway {
namespace {

/// Beside those that are searched: pages that are read meanwhile.
constexpr std::uint32_t kSlotsAhead = 2;

}  // namespace

const GridScene& LazyGridScene::of(const SearchPlan& plan) const {
  if (!scene_->has_value()) scene_->emplace(query_, plan.filter.motion(), store_, options_);
  return scene_->value();
}

void log_statistics(const GridScene& scene, const GridStatistics& s) {
  spdlog::info(
      "grid cell {:.4g} m; tests: {} of spheres, {} of {} moved points searched, {} in "
      "float, {} exact",
      scene.grid_cell(), format_count(s.sphere_tests), format_count(s.searches),
      format_count(s.points_moved), format_count(s.point_tests), format_count(s.exact_tests));
}

PageEngineKind cpu_grid(const StoreReader& store, const Query& query,
                        const EngineOptions& options) {
  const LazyGridScene scene(store, query, options);
  PageEngineKind kind;
  kind.most_slots = static_cast<std::uint32_t>(options.threads) + kSlotsAhead;
  kind.threads = options.threads;
  kind.host_bytes = [scene](const SearchPlan& plan, const SlotLayout& layout) {
    const GridScene& grid = scene.of(plan);
    return grid.size_bytes() + layout.slots * GridCpuEngine::slot_bytes(grid, layout);
  };
  kind.make = [scene](const SearchPlan& plan, const SlotLayout& layout) {
    PageEngines engines;
    engines.push_back(std::make_unique<GridCpuEngine>(scene.of(plan), layout));
    return engines;
  };
  kind.finished = [scene](const SearchPlan& plan, const PageEngines& engines,
                          EngineReport& report) {
    report.grid_cell = scene.of(plan).grid_cell();
    log_statistics(scene.of(plan),
                   dynamic_cast<const GridCpuEngine&>(*engines.front()).statistics());
  };
  return kind;
}

}  // namespace clearway
