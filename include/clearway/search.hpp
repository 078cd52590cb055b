#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "clearway/answer.hpp"
#include "clearway/progress.hpp"
#include "clearway/query.hpp"
#include "clearway/shard.hpp"
#include "clearway/store.hpp"

namespace clearway {

enum class Engine { kAuto, kSweep, kGrid, kKdtree };  ///< kAuto: by estimate
enum class Device { kAuto, kCpu, kCuda };             ///< kAuto: a GPU where there is one with room

const char* name_of(Engine engine);  ///< "auto", "sweep", "grid" or "kdtree"
const char* name_of(Device device);  ///< "auto", "cpu" or "cuda"

class DeviceStart;

/// How a query is searched. Without a tolerance and with exact precision the result's bytes depend
/// on none of it.
struct SearchOptions {
  Engine engine = Engine::kAuto;
  Device device = Device::kAuto;
  std::vector<int> gpus = {};  ///< CUDA's numbers; empty: the first with room
  int threads = 0;             ///< 0: all cores
  std::uint64_t memory_bytes = std::uint64_t{4} << 30;
  std::uint64_t device_memory_bytes = 0;  ///< of each device; 0: 2 GiB, or what is free
  double field_voxel = 0;                 ///< metres, engine sweep; 0: chosen
  double grid_cell = 0;                   ///< metres, engine grid; 0: chosen
  bool float_precision = false;           ///< engine grid decides in floats, for comparison
  /// Searches this part of the environment alone: the output is a part for merge(). The same store,
  /// query and count give the same parts, whatever the other options are.
  std::optional<Shard> shard = {};
  bool overwrite = false;  ///< an existing result, and the journal of an earlier run
  bool resume = false;     ///< goes on from the journal of an earlier run
  bool strict = false;     ///< any warning ends with InputError, nothing searched
  /// Of reading model and trajectory, told already: the report holds them too, as a part does, and
  /// strict counts them. To be given again where a search is resumed.
  std::vector<Message> input_warnings = {};
  /// The model lacks its lowest part, as with ModelOptions::above. Then it does not stand on the
  /// ground, and ignored points that collide are not warned of for their number alone.
  bool model_is_cut = false;
  std::shared_ptr<const DeviceStart> started = nullptr;  ///< start_devices(), or done here
  /// The process uses CUDA for nothing else: the GPUs' contexts end while the result is written.
  bool end_gpus = false;
  double journal_interval_seconds = 5;  ///< between two syncs of the journal to the disk
  ProgressCallback progress = nullptr;
  MessageCallback message = nullptr;  ///< notes, and the warnings that the report holds
  StopFlag stop = nullptr;
};

/// What a tolerance spared.
struct ToleranceReport {
  std::uint64_t model_points_kept = 0, poses_kept = 0;
  std::uint64_t resolved_by_bounds = 0;  ///< exact tests of a point at a single pose not made
};

/// Wall clock, seconds. Those of the search overlap: each is the time in which at least one worker
/// of that stage was busy.
struct SearchSeconds {
  double total = 0;
  double context = 0;       ///< of starting the GPUs, beside all that comes before the engine
  double context_wait = 0;  ///< of it, what the search waited for
  double ignored = 0;       ///< of counting the ignored points that would collide
  double thin = 0;          ///< of choosing what a tolerance keeps
  double field = 0;  ///< of making what the engine looks up: the model field, the grid's groups
  double plan = 0;
  double engine = 0;  ///< of making the engine with its slots
  double search = 0, read = 0, upload = 0, compute = 0, collect = 0;
  double write = 0;     ///< of the result; beside it the GPUs' memory is given back
  double end_wait = 0;  ///< of that, what came after the writing
};

/// Estimated seconds of answering, in which a GPU's start counts.
struct DeviceEstimate {
  double cpu = 0, cuda = 0;
};

/// Of the whole command on the CPU, seconds.
struct EngineEstimate {
  double sweep_seconds = 0, kdtree_seconds = 0;
};

/// What was found, which is the answer, and how. The answer of a result that was there already is
/// read from its file.
struct SearchReport : Answer {
  bool was_finished = false;          ///< the result was there already: nothing was searched
  std::uint64_t model_triangles = 0;  ///< of a surface, whose corners the points are; else 0
  /// Ignored points of the cells that this search looked at: not of a journal's cells, nor of those
  /// that no pose comes near.
  std::uint64_t ignored_looked_at = 0;
  std::vector<Message> warnings;

  Engine engine = Engine::kAuto;                  ///< that searched
  std::optional<EngineEstimate> engine_estimate;  ///< where it chose the engine
  Device device = Device::kCpu;
  std::optional<DeviceEstimate> estimate;  ///< by which device kAuto was resolved
  std::string device_name = "the CPU";     ///< for people
  std::optional<double> shard_share;       ///< of a shard: its estimated work over the mean
  std::uint64_t searches = 0;              ///< pairs of a pose and a model point or triangle
  std::optional<ToleranceReport> tolerance;
  double field_voxel = 0, grid_cell = 0;  ///< metres, of what the engine built; 0: nothing
  std::uint64_t cells_total = 0, cells_read = 0, bytes_read = 0;
  std::uint64_t resumed_cells = 0, resumed_poses = 0;  ///< known from a journal
  std::uint64_t pages = 0, page_bytes = 0;             ///< pages run, and the largest they may be
  std::uint32_t slots = 0;
  std::uint64_t needed_host_bytes = 0;  ///< memory that the search takes at the most
  std::uint64_t pinned_bytes = 0;       ///< of the host, for the GPUs
  std::uint64_t peak_device_bytes = 0;  ///< allocated, without the CUDA context
  SearchSeconds seconds;
};

/// Searches the store for every point within the query's radius of the moving model and writes the
/// result file. Until that is complete, what was found is kept in a journal beside it
/// (`OUTPUT.journal`), from which a call with options.resume goes on. Throws UsageError for a query
/// that the engine cannot answer, an output that exists or a journal of another query; InputError
/// for a damaged store; ResourceError for a full disk, too little memory or a GPU that is not
/// there; Interrupted when asked to stop.
SearchReport search(const Store& store, const Query& query, const std::filesystem::path& output,
                    const SearchOptions& options = {});

/// Begins to start the GPUs that a search with these options takes, and returns at once: for
/// callers that read large inputs first. Goes into SearchOptions::started. Null where nothing is
/// started: with device kAuto without the store, or where it has so few points that the CPU may be
/// taken.
std::shared_ptr<const DeviceStart> start_devices(const SearchOptions& options,
                                                 const Store* store = nullptr);

/// Throws what search() would throw before it looks at store, model and trajectory: for callers
/// that read large inputs first. A result that is there already is left to search(), which says
/// whether it answers the query. As search() does, it replaces a file OUTPUT.partial: see before
/// that no input has that name.
void check_search(const QueryParameters& query, const std::filesystem::path& output,
                  const SearchOptions& options = {});

}  // namespace clearway
