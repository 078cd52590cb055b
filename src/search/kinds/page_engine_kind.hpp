#pragma once

#include <cstdint>
#include <future>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "clearway/search.hpp"
#include "core/page/page_engine.hpp"
#include "core/page/page_pool.hpp"
#include "core/page/pose_reach.hpp"
#include "core/util/message_log.hpp"
#include "search/query_trees.hpp"
#include "stream/plan.hpp"

namespace clearway {

/// One for each device.
using PageEngines = std::vector<std::unique_ptr<PageEngine>>;
using EngineList = std::span<const PageEngine* const>;

/// Engines that are taken down on threads of their own. Its end waits for them.
using EngineEnd = std::vector<std::future<void>>;

/// Slots of an engine on the CPU beside those that are searched: for pages that are read meanwhile.
inline constexpr std::uint32_t kSlotsAhead = 2;

/// What an engine that works on pages wants, at the most and at the least.
struct PageEngineNeeds {
  std::uint32_t most_slots = 1;  ///< with less memory, fewer
  std::uint32_t page_cells = 1;  ///< the most cells of a page
  std::uint64_t page_bytes = 0;  ///< wanted; more where a cell needs it, less with little memory
  int threads = 1;               ///< that run the pipeline, those that wait for a device included
  int waiting_threads = 0;       ///< of them, those that wait
  std::uint32_t devices = 1;     ///< engines that are made
  bool on_gpu = false;
  std::uint64_t most_device_bytes = 0;  ///< of each GPU, once resolved
  std::string short_device = {};        ///< likewise, as refuse_device_memory takes it
};

/// An engine that works on pages before it is made: builds its index of the query, with which the
/// cells are planned, says what memory it takes, and makes it.
class PageEngineKind {
 public:
  /// What an index may take, bytes.
  struct IndexSize {
    std::uint64_t bytes = 0;
    std::uint64_t while_built = 0;  ///< beside the trees, more than afterwards; 0: not counted
  };

  explicit PageEngineKind(PageEngineNeeds needs) : needs_(std::move(needs)) {}
  virtual ~PageEngineKind() = default;

  const PageEngineNeeds& needs() const { return needs_; }

  /// From the best to the least. With a smaller one the search is slower, never another.
  virtual std::vector<IndexSize> index_sizes() const { return {IndexSize{}}; }

  /// Of which query build_index() gets the trees; searched: the query.
  virtual const Query& whose_trees(const Query& searched) const { return searched; }

  /// Builds the index, in the place of an earlier one. The trees outlive it.
  virtual const PoseReach& build_index(const QueryTrees& trees, std::uint64_t most_bytes) = 0;

  /// The plan with that index; `reach` is what build_index() gave.
  virtual std::vector<PlannedCell> plan_cells(const PackedCloud& cloud,
                                              const PoseReach& reach) const {
    return plan(cloud, reach);
  }
  /// Of the nodes of any of these cells; motion: of the trees.
  virtual std::uint64_t most_poses(const MotionTree& motion,
                                   std::span<const PlannedCell> cells) const;

  /// Waits for the devices: from here on needs() has their limits. Called with a plan, before
  /// memory is asked for; may be called again.
  virtual void resolve_devices() {}

  // With an index, and all but index_bytes() with devices:

  virtual std::uint64_t index_bytes() const = 0;
  /// Memory on the host with this layout, bytes: what make() allocates and what searches do.
  /// most_poses: of the motion nodes of any planned cell.
  virtual std::uint64_t host_bytes(const SlotLayout& layout, std::uint64_t most_poses) const = 0;
  /// Memory on each device likewise.
  virtual std::uint64_t device_bytes(const SlotLayout&) const { return 0; }
  /// For the log and the report.
  virtual void report_index(SearchReport& report, const MessageLog& log) const = 0;
  /// Slots of the layout are those of each device. The index outlives the engines' searches.
  virtual PageEngines make(const SlotLayout& layout) = 0;
  /// Called once after the last page: for the log, and for what only the engines can report.
  virtual void report_search(EngineList engines, SearchReport& report,
                             const MessageLog& log) const = 0;
  /// Takes the engines down, beside the caller where that takes long.
  virtual EngineEnd end([[maybe_unused]] PageEngines engines) const {
    engines.clear();
    return {};
  }

 protected:
  PageEngineNeeds needs_;
};

}  // namespace clearway
