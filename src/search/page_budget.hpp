#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "core/page/page_engine.hpp"
#include "core/query/ignored_points.hpp"
#include "io/store/store_reader.hpp"
#include "search/kinds/page_engine_kind.hpp"
#include "search/shard/shard_cells.hpp"

namespace clearway {

/// Finds an index, a plan and a layout that fit the memory. Where memory is short, first the index
/// gets coarser, then slots fewer, then pages smaller; on a GPU, slots get fewer and pages smaller,
/// down to one cell, before the index gets coarser.
class PageBudget {
 public:
  /// asked: the query as the caller put it. searched: what a tolerance leaves of it, in
  /// thinned_bytes bytes. only: the cells to plan, null for all. search: which points are searched;
  /// ignored points are only counted, so that no answer, journal or result takes memory. All
  /// references outlive it.
  PageBudget(const StoreReader& store, const Query& asked, const Query& searched,
             std::uint64_t thinned_bytes, std::uint64_t memory_bytes, PageEngineKind& kind,
             const ShardCells* only, IgnoredPoints::Search search = IgnoredPoints::Search::kOthers);

  /// Throws ResourceError naming the smallest budget that works.
  void find();

  // The following are valid after find():
  std::vector<PlannedCell>& cells() { return cells_; }
  const SlotLayout& layout() const { return layout_; }
  const IgnoredPoints& ignored() const { return ignored_; }
  double index_seconds() const { return trees_.model_seconds + index_seconds_; }
  double plan_seconds() const { return trees_.motion_seconds + plan_seconds_; }
  std::uint64_t needed_bytes() const { return needed_bytes_; }
  /// The bytes of the memory that are left to write the result with.
  std::uint64_t write_bytes() const { return memory_bytes_ - kept_bytes(layout_); }

 private:
  std::uint64_t kept_bytes(const SlotLayout& layout) const;
  std::uint64_t planned_bytes() const;
  bool fits_with(const PageEngineKind::IndexSize& size, bool any_layout);
  SlotLayout as_needed(const SlotLayout& layout) const;
  bool fits(const SlotLayout& layout, std::uint64_t planned, std::uint64_t building,
            std::uint64_t most_poses);

  const StoreReader& store_;
  const Query& asked_;
  const std::uint64_t memory_bytes_;
  PageEngineKind& kind_;
  const ShardCells* only_;
  const bool keeps_answer_;
  const IgnoredPoints ignored_;
  const bool masked_;  ///< whether pages have masks
  const QueryTrees trees_;
  const std::uint64_t building_bytes_;  ///< bytes while the trees are built
  /// Bytes that are kept to the end of the run, except those of the journal.
  const std::uint64_t kept_bytes_;
  std::vector<PlannedCell> cells_;
  SlotLayout layout_;
  double index_seconds_ = 0, plan_seconds_ = 0;  ///< sums over all indices that were tried
  std::uint64_t needed_bytes_ = 0;
  std::optional<std::uint64_t> smallest_bytes_;  ///< the least of what fits the device
  std::uint64_t smallest_device_bytes_ = std::numeric_limits<std::uint64_t>::max();
};

}  // namespace clearway
