#include "search/kinds/grid_kind.hpp"

#include "core/util/format.hpp"
#include "cpu/grid_cpu_engine.hpp"

namespace clearway {

const PoseReach& GridKind::build_index(const QueryTrees& trees, std::uint64_t) {
  scene_.emplace(query_, trees.motion, cloud_, scene_options_);
  return reach_.emplace(query_, trees.motion, trees.of<Vec3>(), cloud_);
}

void GridKind::log_statistics(const GridStatistics& s, const MessageLog& log) const {
  log.note("grid cell " + format_brief(scene_->grid_cell()) + " m; tests: " +
           format_count(s.sphere_tests) + " of spheres, " + format_count(s.searches) + " of " +
           format_count(s.points_moved) + " moved points searched, " + format_count(s.point_tests) +
           " in float, " + format_count(s.exact_tests) + " exact");
}

CpuGridKind::CpuGridKind(const PackedCloud& cloud, const Query& query, const SearchOptions& options,
                         const GridOptions& scene_options)
    : GridKind({.most_slots = static_cast<std::uint32_t>(options.threads) + kSlotsAhead,
                .threads = options.threads},
               cloud, query, scene_options) {}

std::uint64_t CpuGridKind::host_bytes(const SlotLayout& layout, std::uint64_t) const {
  return layout.slots * GridCpuEngine::slot_bytes(*scene_, layout);
}

PageEngines CpuGridKind::make(const SlotLayout& layout) {
  PageEngines engines;
  engines.push_back(std::make_unique<GridCpuEngine>(*scene_, layout));
  return engines;
}

void CpuGridKind::report_search(EngineList engines, SearchReport&, const MessageLog& log) const {
  log_statistics(dynamic_cast<const GridCpuEngine&>(*engines.front()).statistics(), log);
}

}  // namespace clearway
