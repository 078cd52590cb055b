#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "clearway/answer.hpp"
#include "clearway/device.hpp"
#include "clearway/progress.hpp"
#include "clearway/query.hpp"
#include "clearway/shard.hpp"
#include "clearway/store.hpp"

namespace clearway {

/// The engines `grid` and `kdtree` are those of the paper that Clearway starts from: they find the
/// points that collide with a model of points at its poses, and nothing else.
enum class Engine { kSweep, kGrid, kKdtree };

const char* name_of(Engine engine);  ///< "sweep", "grid" or "kdtree"

class DeviceStart;

/// How a query is searched. The result's bytes depend on none of these options.
struct SearchOptions {
  Engine engine = Engine::kSweep;
  Device device = Device::kAuto;
  std::vector<int> gpus = {};  ///< CUDA's device numbers; empty: the first GPU with room
  int threads = 0;             ///< 0: all cores
  std::uint64_t memory_bytes = std::uint64_t{4} << 30;
  std::uint64_t device_memory_bytes = 0;  ///< budget on each device; 0: 2 GiB, or what is free
  /// The part of the environment to search; the output is then a part for merge(). The same store,
  /// query and count give the same parts, whatever the other options are.
  std::optional<Shard> shard = {};
  bool overwrite = false;  ///< replaces an existing result and the journal of an earlier run
  bool resume = false;     ///< continues from the journal of an earlier run
  bool strict = false;     ///< any warning ends with InputError, and nothing is searched
  /// Warnings from reading model and trajectory, which the user has already seen. The report and
  /// the result hold them too, and `strict` counts them. They must be given again to resume a
  /// search.
  std::vector<Message> input_warnings = {};
  /// From start_devices(); null: the search starts them
  std::shared_ptr<const DeviceStart> started = nullptr;
  /// Whether the process uses CUDA for nothing else; the GPUs' contexts then end while the result
  /// is written.
  bool end_gpus = false;
  double journal_interval_seconds = 5;  ///< time between two syncs of the journal to the disk
  ProgressCallback progress = nullptr;
  MessageCallback message = nullptr;  ///< receives notes, and the warnings that the report holds
  StopFlag stop = nullptr;
};

/// Wall-clock seconds of a search. Those of `search` and its stages overlap: each is the time in
/// which at least one worker of that stage was busy.
struct SearchSeconds {
  double total = 0;
  /// Seconds for starting the GPUs, in parallel with everything that comes before the engine
  double context = 0;
  double context_wait = 0;  ///< seconds that the search waited for the GPUs to start
  double check = 0;         ///< seconds for looking at the question before it is searched
  /// Seconds for making what the engine looks up: the model field, the grid's groups
  double field = 0;
  double plan = 0;
  double engine = 0;  ///< seconds for making the engine with its slots
  double search = 0, read = 0, upload = 0, compute = 0, collect = 0;
  double depth = 0;  ///< seconds for finding the free point nearest to each colliding one
  double swept = 0;  ///< seconds for finding the cubes that the model sweeps
  double beams = 0;  ///< seconds for following the scanner's beams through these cubes
  double write = 0;  ///< seconds for writing the result, while the GPUs' memory is given back
  /// Seconds of waiting for the GPUs' memory to be given back after the result was written
  double end_wait = 0;
};

/// The answer of a search, and how it was found. If the result existed already, its answer is read
/// from its file. The warnings of a report may also concern the machine, such as a journal that
/// could not be removed.
struct SearchReport : Answer {
  bool was_finished = false;  ///< true if the result existed already, so that nothing was searched
  /// Triangles of a surface, whose corners are model_points; otherwise 0
  std::uint64_t model_triangles = 0;

  Engine engine = Engine::kSweep;  ///< the engine that searched
  Device device = Device::kCpu;
  std::optional<DeviceEstimate> estimate;  ///< the estimate by which kAuto chose the device
  std::string device_name = "the CPU";     ///< name of the device for the user
  std::optional<double> shard_share;       ///< a shard's estimated work, relative to the mean
  std::uint64_t searches = 0;              ///< pairs of a pose and a model point or triangle
  std::uint64_t cells_total = 0;
  std::uint64_t cells_read = 0;     ///< cells whose points were searched
  BytesRead bytes_read;             ///< by all parts of the search, until the result was written
  std::uint64_t resumed_cells = 0;  ///< cells whose colliding points a journal held
  /// Pages that were run, and the largest size that one may have
  std::uint64_t pages = 0, page_bytes = 0;
  std::uint32_t slots = 0;
  std::uint64_t needed_host_bytes = 0;  ///< greatest memory that the search takes
  std::uint64_t pinned_bytes = 0;       ///< pinned host memory for the GPUs
  std::uint64_t peak_device_bytes = 0;  ///< allocated on the GPU, without the CUDA context
  SearchSeconds seconds;
};

/// Searches the store for every point within the query's radius of the moving model and writes the
/// result file. Until it is complete, what was found is kept in a journal beside it
/// (`OUTPUT.journal`), from which a call with options.resume continues. Throws UsageError for a
/// query that the engine cannot answer, an output that exists or a journal of another query;
/// InputError for a damaged store; ResourceError for a full disk, too little memory or a GPU that
/// is not available; Interrupted when asked to stop.
SearchReport search(const Store& store, const Query& query, const std::filesystem::path& output,
                    const SearchOptions& options = {});

/// Begins to start the GPUs that a search with these options uses, and returns at once, for callers
/// that read large inputs first. The return value goes into SearchOptions::started. It is null if
/// nothing is started: with device kAuto without the store, or if the store has so few points that
/// the CPU may be chosen.
std::shared_ptr<const DeviceStart> start_devices(const SearchOptions& options,
                                                 const Store* store = nullptr);

/// Throws what search() would throw before it reads store, model and trajectory, for callers
/// that read large inputs first. Whether an existing result answers the query is left to search().
/// Like search(), this replaces a file OUTPUT.partial, so make sure that no input has that name.
void check_search(const QueryParameters& query, const std::filesystem::path& output,
                  const SearchOptions& options = {});

}  // namespace clearway
