#include "search/engines.hpp"

#include <spdlog/spdlog.h>
#include <tbb/task_arena.h>

#include <set>

#include "clearway/error.hpp"
#include "search/cuda_run.hpp"
#include "search/devices.hpp"
#include "search/grid_run.hpp"
#include "search/kdtree_run.hpp"
#include "search/sweep_run.hpp"
#include "search/threads.hpp"

namespace clearway {
namespace {

/// A tolerance is the sweep's, and only for sets.
void check_tolerance(const Query& query, const std::string& engine) {
  const char* other = query.first_pose      ? "--first-pose"
                      : query.clearance > 0 ? "--clearance"
                      : query.between_poses ? "--between-poses"
                                            : nullptr;
  if (other != nullptr) {
    throw UsageError(std::string("--tolerance and ") + other +
                     " cannot be combined: without --tolerance, --engine sweep answers " + other +
                     " exactly");
  }
  if (engine != "sweep") {
    throw UsageError("--tolerance: engine " + engine + " is always exact; take --engine sweep");
  }
  if (!(query.tolerance < query.radius)) {
    throw UsageError(
        "--tolerance: must be below the radius; a larger one would allow an empty result");
  }
}

/// The trees over the poses number up to 2 n - 1 nodes.
void check_poses(const Query& query) {
  constexpr std::uint64_t kEnd = std::uint64_t{1} << 31;
  if (query.poses.size() < kEnd) return;
  throw InputError("the trajectory has " + std::to_string(query.poses.size()) +
                   " poses, expected fewer than " + std::to_string(kEnd));
}

PageEngineKind page_engine(const StoreReader& store, const Query& query,
                           const EngineOptions& options,
                           [[maybe_unused]] const DeviceChoice& device) {
#ifdef CLEARWAY_CUDA
  if (device.is_cuda()) {
    return options.engine == "grid" ? cuda_grid(store, query, options, device)
                                    : cuda_sweep(store, options, device);
  }
#endif
  return options.engine == "grid" ? cpu_grid(store, query, options)
                                  : cpu_sweep(store, query, options);
}

/// As run_engine, with the device that was chosen for the options.
SearchResult run_on_pages(const StoreReader& store, const Query& query,
                          const EngineOptions& options, const DeviceChoice& device,
                          const OpenJournal& open_journal, Progress& progress,
                          EngineReport& report) {
  SearchJournal* journal = nullptr;
  const auto open = [&]() -> SearchJournal& {
    if (journal == nullptr) journal = &open_journal(report.engine, report.device);
    return *journal;
  };
  const auto run_on = [&](const DeviceChoice& chosen) {
    report.device = chosen.is_cuda() ? "cuda" : "cpu";
    report.device_name = chosen.name;
    if (!chosen.fallback_allowed) open();  // what is refused is so before it is planned
    return run_page_engine(store, query, options, page_engine(store, query, options, chosen), open,
                           progress, report);
  };
  try {
    return run_on(device);
  } catch (const ResourceError& error) {
    if (journal != nullptr || !device.fallback_allowed) throw;
    spdlog::info("the CPU is taken: {}", error.what());
  }
  return run_on({});
}

}  // namespace

std::string chosen_engine(const EngineOptions& options) {
  return options.engine == "auto" ? "sweep" : options.engine;
}

void check_query(const Query& query, const EngineOptions& options) {
  const std::string engine = chosen_engine(options);
  if (query.tolerance > 0) check_tolerance(query, engine);
  if (query.clearance > 0 && query.between_poses) {
    throw UsageError("--clearance and --between-poses cannot be combined: clearances are at poses");
  }
  if (query.clearance > 0 && engine == "kdtree") {
    throw UsageError("--clearance: engine kdtree has no clearances; take --engine sweep");
  }
  if (engine == "grid" && (query.clearance > 0 || query.between_poses)) {
    throw UsageError(std::string(query.clearance > 0 ? "--clearance" : "--between-poses") +
                     ": engine grid does not offer it; take --engine sweep");
  }
  if (engine != "grid" && (options.grid_cell > 0 || options.float_precision)) {
    throw UsageError("--grid-cell and --precision float need --engine grid");
  }
  if (engine == "kdtree" && (options.field_voxel > 0 || options.device_memory_bytes > 0)) {
    throw UsageError("--engine kdtree takes neither --field-voxel nor --device-memory");
  }
  if (std::set(options.gpus.begin(), options.gpus.end()).size() < options.gpus.size()) {
    throw UsageError("--gpus names a GPU twice");
  }
  if (options.device == "cpu" && (!options.gpus.empty() || options.device_memory_bytes > 0)) {
    throw UsageError("--gpus and --device-memory need --device cuda");
  }
}

SearchResult run_engine(const StoreReader& store, const Query& query, const EngineOptions& options,
                        const OpenJournal& open_journal, Progress& progress, EngineReport& report) {
  EngineOptions resolved = options;
  resolved.engine = chosen_engine(options);
  check_query(query, options);
  check_poses(query);
  const DeviceChoice device = choose_device(resolved);
  if (options.threads == 0) resolved.threads = tbb::this_task_arena::max_concurrency();
  check_threads(resolved.threads);
  report.engine = resolved.engine;
  report.context_seconds = device.context_seconds;
  report.searches = std::uint64_t{query.poses.size()} * query.model.size();
  if (resolved.engine == "kdtree") {
    return run_kdtree_engine(store, query, resolved, open_journal(report.engine, report.device),
                             progress, report);
  }
  return run_on_pages(store, query, resolved, device, open_journal, progress, report);
}

}  // namespace clearway
