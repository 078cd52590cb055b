#include "clearway/engines.hpp"

#include <tbb/task_arena.h>

#include <set>

#include "clearway/cuda_run.hpp"
#include "clearway/devices.hpp"
#include "clearway/grid_run.hpp"
#include "clearway/kdtree_run.hpp"
#include "clearway/sweep_run.hpp"
#include "core/error.hpp"

namespace clearway::tool {
namespace {

/// What the engine cannot do is refused with the name of one that can.
void check(const Question& question, const EngineOptions& options) {
  if (question.clearance > 0 && question.between_poses) {
    throw UsageError("--clearance and --between-poses cannot be combined: clearances are at poses");
  }
  if (question.clearance > 0 && options.engine == "kdtree") {
    throw UsageError("--clearance: engine kdtree has no clearances; take --engine sweep");
  }
  if (options.engine == "grid" && (question.clearance > 0 || question.between_poses)) {
    throw UsageError(std::string(question.clearance > 0 ? "--clearance" : "--between-poses") +
                     ": engine grid does not offer it; take --engine sweep");
  }
  if (options.engine != "grid" && (options.grid_cell > 0 || options.float_precision)) {
    throw UsageError("--grid-cell and --precision float are of --engine grid");
  }
  if (std::set(options.gpus.begin(), options.gpus.end()).size() < options.gpus.size()) {
    throw UsageError("--gpus names a GPU twice");
  }
  if (options.device == "cpu" && (!options.gpus.empty() || options.device_memory_bytes > 0)) {
    throw UsageError("--gpus and --device-memory are of --device cuda");
  }
}

PageEngineKind page_engine(const Store& store, const Question& question,
                           const EngineOptions& options,
                           [[maybe_unused]] const DeviceChoice& device) {
#ifdef CLEARWAY_CUDA
  if (device.is_cuda()) {
    return options.engine == "grid" ? cuda_grid(store, question, options, device)
                                    : cuda_sweep(store, options, device);
  }
#endif
  return options.engine == "grid" ? cpu_grid(store, question, options)
                                  : cpu_sweep(store, question, options);
}

}  // namespace

Answer run_engine(const Store& store, const Question& question, const EngineOptions& options,
                  const OpenJournal& open_journal, Progress& progress, EngineReport& report) {
  EngineOptions resolved = options;
  if (options.engine == "auto") resolved.engine = "sweep";
  check(question, resolved);
  const DeviceChoice device = choose_device(resolved);
  if (options.threads == 0) resolved.threads = tbb::this_task_arena::max_concurrency();
  report.engine = resolved.engine;
  report.device = device.is_cuda() ? "cuda" : "cpu";
  report.device_name = device.name;
  report.context_seconds = device.context_seconds;
  report.searches = std::uint64_t{question.poses.size()} * question.model.size();
  AnswerJournal& journal = open_journal(report.engine, report.device);
  if (resolved.engine == "kdtree") {
    return run_kdtree_engine(store, question, resolved, journal, progress, report);
  }
  return run_page_engine(store, question, resolved, page_engine(store, question, resolved, device),
                         journal, progress, report);
}

}  // namespace clearway::tool
