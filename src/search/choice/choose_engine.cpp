#include "search/choice/choose_engine.hpp"

#include "core/util/format.hpp"
#include "search/choice/cpu_estimate.hpp"
#include "search/kdtree_search.hpp"

namespace clearway {
namespace {

/// Whether engine kdtree can answer the query within the memory, and its time is known well enough
/// to be compared.
bool may_be_kdtree(const StoreReader& store, const Query& query, const SearchOptions& options) {
  const bool asks_for_sweep = query.clearance > 0 || query.profile > 0 || query.tolerance > 0 ||
                              query.between_poses || query.model.is_surface() ||
                              !query.bodies.empty() || options.field_voxel > 0;
  return !asks_for_sweep && kdtree_needed_bytes(store, query, options) <= options.memory_bytes;
}

}  // namespace

void choose_engine(const StoreReader& store, const Query& query, Engine earlier, bool on_gpu,
                   SearchOptions& options, SearchReport& report, const MessageLog& log) {
  if (options.engine != Engine::kAuto) return;
  options.engine = Engine::kSweep;
  if (on_gpu || earlier == Engine::kSweep) return;
  if (earlier == Engine::kKdtree && options.field_voxel == 0) {
    options.engine = earlier;
    return;
  }
  if (!may_be_kdtree(store, query, options)) return;
  const EngineEstimate estimate = estimate_on_cpu(workload_of(store, query), options.threads);
  if (estimate.kdtree_seconds < estimate.sweep_seconds) options.engine = Engine::kKdtree;
  report.engine_estimate = estimate;
  log.note("engine " + std::string(name_of(options.engine)) +
           " is taken: by estimate sweep needs " + format_brief(estimate.sweep_seconds) +
           " s and kdtree " + format_brief(estimate.kdtree_seconds) + " s");
}

}  // namespace clearway
