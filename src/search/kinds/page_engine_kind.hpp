#pragma once

#include <cstdint>
#include <future>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "clearway/search.hpp"
#include "core/grid/grid_scene.hpp"
#include "core/messages/messages.hpp"
#include "core/page/page_engine.hpp"
#include "core/page/page_pool.hpp"
#include "core/page/pose_reach.hpp"
#include "search/query_trees.hpp"
#include "stream/plan.hpp"

namespace clearway {

/// The engines of a search, one for each device.
using PageEngines = std::vector<std::unique_ptr<PageEngine>>;
using EngineList = std::span<const PageEngine* const>;

/// Engines that are being taken down on other threads. Its destructor waits for them.
using EngineEnd = std::vector<std::future<void>>;

/// Settings of the engines that only experiments change. In single precision an answer is not
/// exact.
struct EngineSettings {
  double field_voxel = 0;  ///< step of the model field of engine sweep, metres; 0: chosen
  GridOptions grid = {};
};

/// The resources that an engine that works on pages wants.
struct PageEngineNeeds {
  /// Slots of each device; fewer where memory is short.
  std::uint32_t most_slots = 1;
  std::uint32_t page_cells = 1;  ///< the most cells of a page
  /// Bytes of a page; more where a cell needs it, fewer where memory is short.
  std::uint64_t page_bytes = 0;
  /// Threads that run the pipeline, including those that wait for a device.
  int threads = 1;
  int waiting_threads = 0;    ///< how many of the threads wait for a device
  std::uint32_t devices = 1;  ///< the number of engines, one for each device
  bool on_gpu = false;
  bool masked = false;  ///< whether pages have masks also where no point is ignored
  /// Whether there are several questions, which are asked one by one where memory is short: then
  /// only the two best indexes and the best layout will do.
  bool may_be_divided = false;
  /// Bytes that may be taken on each GPU, once devices are resolved.
  std::uint64_t most_device_bytes = 0;
  /// Once devices are resolved, the name that refuse_device_memory() takes.
  std::string short_device = {};
};

/// The needs of an engine on the CPU. It has two slots besides those being searched, for pages that
/// are read at the same time.
inline PageEngineNeeds cpu_needs(const SearchOptions& options) {
  return {.most_slots = static_cast<std::uint32_t>(options.threads) + 2,
          .threads = options.threads};
}

/// The engines of a search on the CPU, which has only one.
inline PageEngines only(std::unique_ptr<PageEngine> engine) {
  PageEngines engines;
  engines.push_back(std::move(engine));
  return engines;
}

/// An engine that works on pages, before it is made: builds its index of the query, with which the
/// cells are planned, says how much memory it takes, and makes the engines.
class PageEngineKind {
 public:
  /// Bytes that an index may take.
  struct IndexSize {
    std::uint64_t bytes = 0;
    /// Bytes that building it takes besides the trees, more than it keeps afterwards; 0 where these
    /// are not counted.
    std::uint64_t while_built = 0;
  };

  explicit PageEngineKind(PageEngineNeeds needs) : needs_(std::move(needs)) {}
  virtual ~PageEngineKind() = default;

  const PageEngineNeeds& needs() const { return needs_; }

  /// Takes the indexes of models from `models`, which outlives the kind, and keeps them there.
  /// hashes: hash_of_model() of the query's model, or of each body's; none: they are computed.
  void keep_models_in(KeptModels& models, std::vector<std::uint64_t> hashes) {
    models_ = &models;
    model_hashes_ = std::move(hashes);
  }
  /// The trees of a query that this kind searches, which outlives them. body: the body whose query
  /// it is.
  QueryTrees trees_of(const Query& query, std::size_t body = 0) const {
    std::optional<std::uint64_t> hash;
    if (body < model_hashes_.size()) hash = model_hashes_[body];
    return QueryTrees(query, needs_.threads - needs_.waiting_threads, models_, hash);
  }

  /// Index sizes from the best to the least. With a smaller index the search is slower, but its
  /// answer is the same.
  virtual std::vector<IndexSize> index_sizes() const { return {IndexSize{}}; }

  /// The query whose trees build_index() gets. searched: the whole query as it is searched.
  virtual const Query& whose_trees(const Query& searched) const { return searched; }

  /// Builds the index, in the place of an earlier one. The trees outlive it.
  virtual const PoseReach& build_index(const QueryTrees& trees, std::uint64_t most_bytes) = 0;

  /// Plans the cells with the index. reach: what build_index() returned.
  virtual std::vector<PlannedCell> plan_cells(const PackedCloud& cloud,
                                              const PoseReach& reach) const {
    return plan(cloud, reach);
  }
  /// The most poses of the motion nodes of any of these cells. motion: the one of the trees.
  virtual std::uint64_t most_poses(const MotionTree& motion,
                                   std::span<const PlannedCell> cells) const;

  /// Waits for the devices, after which needs() has their limits. Called when there is a plan,
  /// before memory is asked for; may be called more than once.
  virtual void resolve_devices() {}

  // The following need an index, and all but index_bytes() also resolved devices.

  virtual std::uint64_t index_bytes() const = 0;
  /// Bytes of memory on the host with this layout: what make() allocates and what searches take.
  /// most_poses: the most poses of the motion nodes of any planned cell.
  virtual std::uint64_t host_bytes(const SlotLayout& layout, std::uint64_t most_poses) const = 0;
  /// Bytes of memory on each device with this layout: what make() allocates and what searches take.
  virtual std::uint64_t device_bytes(const SlotLayout&) const { return 0; }
  /// device_bytes() without what stays on the devices for other searches too.
  virtual std::uint64_t own_device_bytes(const SlotLayout& layout) const {
    return device_bytes(layout);
  }
  /// Describes the index in the log, where it is one that people may want to know of.
  virtual void log_index([[maybe_unused]] const MessageLog& log) const {}
  /// Makes an engine for each device, each with the layout's number of slots. The index outlives
  /// the engines' searches.
  virtual PageEngines make(const SlotLayout& layout) = 0;
  /// Called once after the last page: describes the search in the log, and reports what only the
  /// engines know.
  virtual void report_search(EngineList engines, SearchReport& report,
                             const MessageLog& log) const = 0;
  /// Takes the engines down, on other threads where that takes long.
  virtual EngineEnd end([[maybe_unused]] PageEngines engines) const {
    engines.clear();
    return {};
  }

 protected:
  PageEngineNeeds needs_;

 private:
  KeptModels* models_ = nullptr;
  std::vector<std::uint64_t> model_hashes_;
};

}  // namespace clearway
