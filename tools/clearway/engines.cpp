#include "clearway/engines.hpp"

#include <spdlog/spdlog.h>
#include <tbb/task_arena.h>

#include "clearway/options.hpp"
#include "clearway/stopwatch.hpp"
#include "core/error.hpp"
#include "core/model_field.hpp"
#include "core/motion_tree.hpp"
#include "core/sweep_filter.hpp"
#include "cpu/kdtree_engine.hpp"
#include "cpu/sweep_engine.hpp"
#include "stream/plan.hpp"
#include "stream/run_cells.hpp"

namespace clearway::tool {
namespace {

std::uint64_t input_bytes(const Store& store, const Question& question) {
  return store.allocated_bytes() + question.model.size_bytes() + question.poses.size_bytes();
}

void check_memory(std::uint64_t needed, std::uint64_t allowed) {
  if (needed > allowed) {
    throw ResourceError("--memory " + format_size(allowed) + " is too little: this run needs " +
                        format_size(needed) + " beside the mapped store");
  }
}

HitSet run_kdtree_engine(const Store& store, const Question& question, const EngineOptions& options,
                         Progress& progress, EngineReport& report) {
  report.needed_bytes =
      input_bytes(store, question) + kdtree_memory_bytes(store, question, options.threads);
  check_memory(report.needed_bytes, options.memory_bytes);
  const Stopwatch compute;
  HitSet hits = run_kdtree(store, question, {.threads = options.threads}, progress);
  report.compute_seconds = compute.seconds();
  return hits;
}

HitSet run_sweep_engine(const Store& store, const Question& question, const EngineOptions& options,
                        Progress& progress, EngineReport& report) {
  const Stopwatch field_time;
  const ModelTree model(question.model);
  const ModelField field(model, question.radius, {.voxel = options.field_voxel}, options.threads);
  report.field_seconds = field_time.seconds();

  const Stopwatch plan_time;
  const MotionTree motion(question.poses, model.box(), question.between_poses);
  const SweepFilter filter(question, motion, model, field, store);
  const std::vector<PlannedCell> cells = plan(store, motion, filter);
  report.plan_seconds = plan_time.seconds();

  const Stopwatch compute;
  SweepEngine engine(store, filter);
  HitSet hits = run_cells(store, cells, engine, question.first_pose, options.threads, progress);
  report.compute_seconds = compute.seconds();
  const SweepStatistics& s = engine.statistics();
  spdlog::info("model field: voxel {:.4g} m, {} bricks, {}", field.voxel(),
               format_count(field.bricks()), format_size(field.allocated_bytes()));
  spdlog::info("tests: {} of boxes, {} of points ({} points), {} exact", format_count(s.node_tests),
               format_count(s.point_tests), format_count(s.points_tested),
               format_count(s.exact_tests));
  return hits;
}

}  // namespace

HitSet run_engine(const Store& store, const Question& question, const EngineOptions& options,
                  Progress& progress, EngineReport& report) {
  EngineOptions resolved = options;
  if (options.threads == 0) resolved.threads = tbb::this_task_arena::max_concurrency();
  report.engine = options.engine == "kdtree" ? "kdtree" : "sweep";
  report.searches = std::uint64_t{question.poses.size()} * question.model.size();
  return report.engine == "kdtree" ? run_kdtree_engine(store, question, resolved, progress, report)
                                   : run_sweep_engine(store, question, resolved, progress, report);
}

}  // namespace clearway::tool
