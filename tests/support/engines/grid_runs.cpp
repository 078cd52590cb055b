#include "support/engines/grid_runs.hpp"

#include "clearway/error.hpp"
#include "cpu/grid_cpu_engine.hpp"
#include "cpu/kdtree_engine.hpp"
#include "stream/run_pages.hpp"
#include "support/engines/answer_sets.hpp"

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
  std::vector<PlannedCell> cells;
  if (motion.nodes().empty()) return cells;
  for (std::uint32_t cell = 0; cell < cloud.cells().size(); ++cell) {
    std::vector<std::uint32_t> nodes;
    const std::uint32_t most = cell % 4 == 0   ? 0xffffffff
                               : cell % 4 == 1 ? 20
                               : cell % 4 == 2 ? 7
                                               : 1;
    add_nodes(motion, 0, most, nodes);
    cells.push_back({cell, std::move(nodes)});
  }
  return cells;
}

using RunIn = std::function<HitSet(PageEngine& engine)>;

/// Plans and stages every cell, and returns what `make` finds with an engine of its own.
HitSet run_staged(const PackedCloud& cloud, const Query& query, const GridRun& run,
                  const std::function<HitSet(const MotionTree& motion, std::uint64_t page_bytes,
                                             const RunIn& run_in)>& make) {
  if (query.model.empty()) return HitSet(cloud.entry_count(), false);
  const MotionTree motion(query.poses, ModelGroups(query.model.vertices).box());
  const std::vector<PlannedCell> cells = plan_everything(cloud, motion);
  const bool masked = query.ignores_points();
  const std::uint64_t page_bytes = run.cells_a_page * smallest_page_bytes(cloud, cells, masked);
  return make(motion, page_bytes, [&](PageEngine& engine) {
    NoProgress progress;
    StageTimes times;
    const auto pages = paginate(cloud, cells, page_bytes, run.cells_a_page, masked);
    PageEngine* const engines[] = {&engine};
    return clearway::run_pages(cloud, cells, pages, engines, query, run.threads, progress, times)
        .hits;
  });
}

}  // namespace

HitSet run_grid(const PackedCloud& cloud, const Query& query, const GridRun& run,
                GridStatistics* statistics) {
  return run_grid(
      cloud, query, run, [&](const GridScene& scene, std::uint64_t page_bytes, const auto& run_in) {
        GridCpuEngine engine(scene, {run.slots, page_bytes, run.cells_a_page}, run.work_list);
        HitSet hits = run_in(engine);
        if (statistics != nullptr) statistics->add(engine.statistics());
        return hits;
      });
}

HitSet run_grid(const PackedCloud& cloud, const Query& query, const GridRun& run,
                const RunPages& run_pages) {
  return run_staged(cloud, query, run,
                    [&](const MotionTree& motion, std::uint64_t page_bytes, const RunIn& run_in) {
                      const GridScene scene(query, motion, cloud, run.options);
                      return run_pages(scene, page_bytes, run_in);
                    });
}

HitSet run_kdtree(const PackedCloud& cloud, const Query& query, const GridRun& run) {
  return run_staged(cloud, query, run,
                    [&](const MotionTree& motion, std::uint64_t page_bytes, const RunIn& run_in) {
                      const SpheresOnPath path(query, motion);
                      KdTreeEngine engine(cloud, path, {run.slots, page_bytes, run.cells_a_page});
                      return run_in(engine);
                    });
}

}  // namespace clearway
