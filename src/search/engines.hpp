#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "clearway/query.hpp"
#include "core/query/search_result.hpp"
#include "core/util/progress.hpp"
#include "io/store/store_reader.hpp"
#include "stream/search_journal.hpp"
#include "stream/stage_times.hpp"

namespace clearway {

struct EngineOptions {
  std::string engine = "auto";  ///< "auto", "sweep", "grid" or "kdtree"
  std::string device = "auto";  ///< "auto", "cpu" or "cuda"
  std::vector<int> gpus;        ///< CUDA's numbers; empty: the first with room
  int threads = 0;              ///< 0: all cores
  double field_voxel = 0;       ///< metres; 0: chosen
  double grid_cell = 0;         ///< metres; 0: chosen
  bool float_precision = false;
  std::uint64_t memory_bytes = std::uint64_t{4} << 30;
  std::uint64_t device_memory_bytes = 0;  ///< of each device; 0: 2 GiB, or what is free
};

/// What a tolerance spared.
struct ToleranceReport {
  std::uint64_t model_points_kept = 0, poses_kept = 0;
  std::uint64_t resolved_by_bounds = 0;  ///< exact tests of a point at a single pose not made
  double thin_seconds = 0;               ///< wall clock
};

/// How an answer was computed.
struct EngineReport {
  std::string engine, device = "cpu";
  std::string device_name = "the CPU";       ///< for people
  std::uint64_t searches = 0;                ///< pairs of pose and model point
  std::optional<ToleranceReport> tolerance;  ///< where the query has one
  double context_seconds = 0;                ///< wall clock, like all of them
  double plan_seconds = 0, field_seconds = 0;
  double engine_seconds = 0;  ///< of making the engine with its slots
  StageTimes stages;
  double field_voxel = 0, grid_cell = 0;  ///< metres, of what the engine built; 0: nothing
  std::uint64_t resumed_cells = 0, resumed_poses = 0;  ///< known from a journal
  std::uint64_t pages = 0, page_bytes = 0;             ///< pages run, and the largest they may be
  std::uint32_t slots = 0;
  std::uint64_t needed_bytes = 0;       ///< memory that the run takes at the most
  std::uint64_t write_bytes = 0;        ///< of --memory, what is left to write the answer with
  std::uint64_t pinned_bytes = 0;       ///< of the host, which the process does not own alone
  std::uint64_t peak_device_bytes = 0;  ///< allocated, without the CUDA context
};

/// The journal that a run with this engine ("sweep", "grid", "kdtree") on this device ("cpu",
/// "cuda") keeps its answer in.
using OpenJournal =
    std::function<SearchJournal&(const std::string& engine, const std::string& device)>;

/// The engine that these options choose: "sweep", "grid" or "kdtree".
std::string chosen_engine(const EngineOptions& options);

/// Throws UsageError, with the name of one that can, where the engine cannot answer such a
/// query, whatever its model and poses.
void check_query(const Query& query, const EngineOptions& options);

/// Answers the query with the engine and device chosen, as far as the journal does not; the
/// journal is opened once. A GPU that was not asked for and proves too small, or fails, before that
/// gives way to the CPU. Throws UsageError where that engine cannot, ResourceError where the device
/// is not there or, before cells are read, where a memory bound is too little; InputError for a
/// damaged cell or a journal that is refused; Interrupted when the progress asks to stop.
SearchResult run_engine(const StoreReader& store, const Query& query, const EngineOptions& options,
                        const OpenJournal& open_journal, Progress& progress, EngineReport& report);

}  // namespace clearway
