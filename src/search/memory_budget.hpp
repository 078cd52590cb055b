#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "clearway/query.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "core/page/page_engine.hpp"
#include "core/query/ignored_points.hpp"
#include "search/kinds/page_engine_kind.hpp"
#include "search/shard_cells.hpp"

namespace clearway {

/// Finds an index, a plan and a layout that fit the memory. Where memory is short, first the index
/// gets coarser, then slots fewer, then pages smaller; on a GPU, slots get fewer and pages smaller,
/// down to one cell, before the index gets coarser.
class PageBudget {
 public:
  /// only: the cells to plan, null for all. write_bytes: the least memory with which the answer is
  /// written; nullopt where the caller takes the answer page by page, so that no answer, journal or
  /// result takes memory. search: which points are searched. All references outlive it.
  PageBudget(const PackedCloud& cloud, const Query& query, std::uint64_t memory_bytes,
             PageEngineKind& kind, const ShardCells* only, std::optional<std::uint64_t> write_bytes,
             IgnoredPoints::Search search = IgnoredPoints::Search::kOthers);

  /// Throws ResourceError naming the smallest budget that works.
  void find();

  // The following are valid after find():
  std::vector<PlannedCell>& cells() { return cells_; }
  const SlotLayout& layout() const { return layout_; }
  /// What the masks of pages leave out; null where pages have none.
  const IgnoredPoints* masks() const { return masked_ ? &ignored_ : nullptr; }
  double index_seconds() const { return trees_.model_seconds + index_seconds_; }
  double plan_seconds() const { return trees_.motion_seconds + plan_seconds_; }
  std::uint64_t needed_bytes() const { return needed_bytes_; }
  /// The bytes of the memory that are left to write the result with.
  std::uint64_t write_bytes() const { return memory_bytes_ - kept_bytes(layout_); }

 private:
  std::uint64_t kept_bytes(const SlotLayout& layout) const;
  std::uint64_t planned_bytes() const;
  bool fits_with(const PageEngineKind::IndexSize& size, bool any_layout);
  bool fits(const SlotLayout& layout, std::uint64_t planned, std::uint64_t building,
            std::uint64_t most_poses);

  const PackedCloud& cloud_;
  const Query& query_;
  const std::uint64_t memory_bytes_;
  PageEngineKind& kind_;
  const ShardCells* only_;
  const std::optional<std::uint64_t> least_write_bytes_;
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

// How many pages of which size an engine may hold at a time.

/// The layouts that an engine may have, from the best to the least.
std::vector<SlotLayout> layouts(const PageEngineNeeds& needs, std::uint64_t least_page_bytes);

/// A layout reduced to what the pages of these cells fill; the pages stay the same.
SlotLayout needed_layout(const PackedCloud& cloud, std::span<const PlannedCell> cells, bool masked,
                         std::uint32_t devices, const SlotLayout& layout);

// The bytes that a run takes of the memory budget, besides the mapped store.

/// Bytes of the program itself: its libraries' data, stacks of threads, buffers of files.
std::uint64_t program_bytes(int threads);

/// Bytes of the cloud's index, of models and of poses.
std::uint64_t input_bytes(const PackedCloud& cloud, const Query& query);

/// Bytes that a search keeps of what it finds until the result is written: the places of the rows,
/// nearest points and chainage of all poses, what the search for depths takes, and the inputs of
/// further searches.
std::uint64_t search_result_bytes(const PackedCloud& cloud, const Query& query);

/// Bytes that the search for depths takes and that writing them takes more than writing other
/// points; 0 where depths are not asked for.
std::uint64_t depth_bytes(const PackedCloud& cloud, const Query& query);

/// What writing takes more where rows have depths: their two columns of encoded pieces, and rows
/// that are longer.
inline constexpr std::uint64_t kDeepWriteBytes = std::uint64_t{4} << 20;

/// Bytes that are taken while the trees over model and poses are built.
std::uint64_t tree_building_bytes(const Query& query);

/// Throws ResourceError, naming what is needed, where that is more than `allowed`.
void check_memory(std::uint64_t needed, std::uint64_t allowed);

/// Throws ResourceError that says how much memory is needed and what to do.
[[noreturn]] void refuse_memory(std::uint64_t needed, std::uint64_t allowed);
/// Throws ResourceError that says how much device memory is needed and what to do. short_device:
/// the device whose free memory is too little; empty where the limit is the budget.
[[noreturn]] void refuse_device_memory(std::uint64_t needed, std::uint64_t allowed,
                                       const std::string& short_device);

}  // namespace clearway
