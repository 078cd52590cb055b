#include "support/grid_runs.hpp"

#include <algorithm>

#include "core/error.hpp"
#include "grid/grid_cpu_engine.hpp"
#include "support/page_stage.hpp"

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

}  // namespace

HitSet run_grid(const PackedCloud& cloud, const Question& question, const GridRun& run) {
  if (question.model.empty()) return HitSet(cloud.slot_count(), question.first_pose);
  Box box{question.model[0], question.model[0]};
  for (const Vec3& m : question.model) {
    for (int k = 0; k < 3; ++k) {
      box.lo[k] = std::min(box.lo[k], m[k]);
      box.hi[k] = std::max(box.hi[k], m[k]);
    }
  }
  const MotionTree motion(question.poses, box);
  const std::vector<PlannedCell> cells = plan_everything(cloud, motion);
  GridCpuOptions options{.slots = run.slots,
                         .page_cells = static_cast<std::uint32_t>(run.cells_a_page),
                         .work_list = run.work_list};
  for (std::size_t i = 0; i < cells.size(); i += run.cells_a_page) {
    const auto page = std::span(cells).subspan(i, std::min(run.cells_a_page, cells.size() - i));
    options.page_bytes = std::max(options.page_bytes, shape_of(cloud, page).bytes());
  }
  const GridScene scene(question, motion, cloud, run.options);
  GridCpuEngine engine(scene, options);
  return run_page_engine(cloud, cells, run.cells_a_page, question.first_pose, engine);
}

}  // namespace clearway
