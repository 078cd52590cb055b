#include "support/engines/grid_runs.hpp"

#include "cpu/kdtree_engine.hpp"

namespace clearway {
namespace {

void add_nodes(const MotionTree& motion, std::uint32_t index, std::uint32_t most,
               std::vector<std::uint32_t>& out) {
  const MotionNode& node = motion.nodes()[index];
  if (node.count <= most) {
    out.push_back(index);
    return;
  }
  add_nodes(motion, index + 1, most, out);
  add_nodes(motion, node.later, most, out);
}

std::vector<PlannedCell> plan_everything(const PackedCloud& cloud, const MotionTree& motion) {
  constexpr std::uint32_t kMost[] = {0xffffffff, 20, 7, 1};
  std::vector<PlannedCell> cells;
  if (motion.nodes().empty()) return cells;
  for (std::uint32_t cell = 0; cell < cloud.cells().size(); ++cell) {
    add_nodes(motion, 0, kMost[cell % 4], cells.emplace_back(PlannedCell{cell, {}}).nodes);
  }
  return cells;
}

/// Plans and stages every cell, and returns what `make` finds with an engine of its own.
template <typename Make>
SearchResult run_staged(const PackedCloud& cloud, const Query& query, const GridRun& run,
                        const Make& make) {
  if (query.model.empty()) return empty_result(cloud, query);
  const MotionTree motion(query.poses, ModelGroups(query.model.vertices).box());
  const std::vector<PlannedCell> cells = plan_everything(cloud, motion);
  const bool masked = query.ignores_points();
  const SlotLayout layout{run.slots, run.cells_a_page * smallest_page_bytes(cloud, cells, masked),
                          run.cells_a_page};
  return make(motion, layout, [&](PageEngine& engine) {
    NoProgress progress;
    StageTimes times;
    const auto pages = paginate(cloud, cells, layout.page_bytes, layout.cells, masked);
    PageEngine* const engines[] = {&engine};
    return run_pages(cloud, cells, pages, engines, query, run.threads, progress, times);
  });
}

}  // namespace

SearchResult run_grid(const PackedCloud& cloud, const Query& query, const GridRun& run,
                      GridStatistics* statistics) {
  return run_grid(cloud, query, run,
                  [&](const GridScene& scene, const SlotLayout& layout, const RunIn& run_in) {
                    GridCpuEngine engine(scene, layout, run.work_list);
                    SearchResult found = run_in(engine);
                    if (statistics != nullptr) statistics->add(engine.statistics());
                    return found;
                  });
}

SearchResult run_grid(
    const PackedCloud& cloud, const Query& query, const GridRun& run,
    const std::function<SearchResult(const GridScene& scene, const SlotLayout& layout,
                                     const RunIn& run_in)>& run_pages) {
  return run_staged(cloud, query, run,
                    [&](const MotionTree& motion, const SlotLayout& layout, const RunIn& run_in) {
                      return run_pages(GridScene(query, motion, cloud, run.options), layout,
                                       run_in);
                    });
}

SearchResult run_kdtree(const PackedCloud& cloud, const Query& query, const GridRun& run) {
  return run_staged(cloud, query, run,
                    [&](const MotionTree& motion, const SlotLayout& layout, const RunIn& run_in) {
                      const SpheresOnPath path(query, motion);
                      KdTreeEngine engine(cloud, path, layout);
                      return run_in(engine);
                    });
}

}  // namespace clearway
