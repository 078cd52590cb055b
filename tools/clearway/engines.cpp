#include "clearway/engines.hpp"

#include <spdlog/spdlog.h>
#include <tbb/task_arena.h>

#include <algorithm>

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

Answer run_kdtree_engine(const Store& store, const Question& question, const EngineOptions& options,
                         Progress& progress, EngineReport& report) {
  report.needed_bytes =
      input_bytes(store, question) + kdtree_memory_bytes(store, question, options.threads);
  check_memory(report.needed_bytes, options.memory_bytes);
  const Stopwatch compute;
  HitSet hits = run_kdtree(store, question, {.threads = options.threads}, progress);
  report.compute_seconds = compute.seconds();
  return {std::move(hits), ClearanceSet()};
}

/// Of the answer, the trees over model and poses: at the most 48 bytes a model point, and 144 a
/// pose while its tree is built.
std::uint64_t sweep_memory_bytes(const Store& store, const Question& question) {
  const std::uint64_t a_slot = (question.first_pose ? 4 : 0) + (question.clearance > 0 ? 12 : 0);
  const std::uint64_t a_pose = 144 + (question.clearance > 0 ? 4 : 0);
  return store.slot_count() / 8 + a_slot * store.slot_count() + 48 * question.model.size() +
         a_pose * question.poses.size();
}

Answer run_sweep_engine(const Store& store, const Question& question, const EngineOptions& options,
                        Progress& progress, EngineReport& report) {
  const std::uint64_t needed = input_bytes(store, question) + sweep_memory_bytes(store, question);
  check_memory(needed, options.memory_bytes);
  const Stopwatch field_time;
  const ModelTree model(question.model);
  ModelFieldOptions field_options{.voxel = options.field_voxel, .reach = question.clearance};
  field_options.most_bytes =
      std::min(field_options.most_bytes, (options.memory_bytes - needed) / 2 + 1);
  const ModelField field(model, question.radius, field_options, options.threads);
  report.needed_bytes = needed + field.allocated_bytes();
  check_memory(report.needed_bytes, options.memory_bytes);
  report.field_seconds = field_time.seconds();

  const Stopwatch plan_time;
  const MotionTree motion(question.poses, model.box(), question.between_poses);
  const SweepFilter filter(question, motion, model, field, store);
  const std::vector<PlannedCell> cells = plan(store, motion, filter);
  report.plan_seconds = plan_time.seconds();

  const Stopwatch compute;
  SweepEngine engine(store, filter);
  Answer answer = run_cells(store, cells, engine, question, options.threads, progress);
  report.compute_seconds = compute.seconds();
  const SweepStatistics& s = engine.statistics();
  spdlog::info("model field: voxel {:.4g} m, {} bricks, {}", field.voxel(),
               format_count(field.bricks()), format_size(field.allocated_bytes()));
  spdlog::info("tests: {} of boxes, {} of points ({} points), {} exact", format_count(s.node_tests),
               format_count(s.point_tests), format_count(s.points_tested),
               format_count(s.exact_tests));
  return answer;
}

}  // namespace

Answer run_engine(const Store& store, const Question& question, const EngineOptions& options,
                  Progress& progress, EngineReport& report) {
  if (question.clearance > 0 && question.between_poses) {
    throw UsageError("--clearance and --between-poses cannot be combined: clearances are at poses");
  }
  if (question.clearance > 0 && options.engine == "kdtree") {
    throw UsageError("--clearance: engine kdtree has no clearances; take --engine sweep");
  }
  EngineOptions resolved = options;
  if (options.threads == 0) resolved.threads = tbb::this_task_arena::max_concurrency();
  report.engine = options.engine == "kdtree" ? "kdtree" : "sweep";
  report.searches = std::uint64_t{question.poses.size()} * question.model.size();
  return report.engine == "kdtree" ? run_kdtree_engine(store, question, resolved, progress, report)
                                   : run_sweep_engine(store, question, resolved, progress, report);
}

}  // namespace clearway::tool
