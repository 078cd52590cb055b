#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "core/page/page_engine.hpp"
#include "core/page/page_pool.hpp"
#include "cpu/range_search.hpp"

namespace clearway {

/// The engine `kdtree`: for every pose and model point a fixed-range search in the k-d tree of a
/// cell. It finds the points that collide at the poses, and nothing else. `start` searches in the
/// thread that calls it. Source: Schauer et al. (the paper), section 3.1 (kd-CD-simple).
class KdTreeEngine final : public PageEngine {
 public:
  /// cloud, path: must outlive the engine. All memory is allocated here.
  KdTreeEngine(const PackedCloud& cloud, const SpheresOnPath& path, const SlotLayout& layout);

  std::uint32_t slots() const override { return pool_.layout().slots; }
  std::span<std::byte> page(std::uint32_t slot) override { return pool_.page(slot); }
  void start(std::uint32_t slot, const PageShape& shape) override;
  PageResult finish(std::uint32_t slot) override { return results_[slot]; }

  /// RangeSearch::tested_searches() of all finished pages.
  std::uint64_t tested_searches() const;

  /// Greatest memory of one slot, bytes.
  static std::uint64_t slot_bytes(const PackedCloud& cloud, const SpheresOnPath& path,
                                  const SlotLayout& layout);

 private:
  std::uint32_t blocks_per_cell_;
  PagePool pool_;
  std::deque<RangeSearch> searches_;  ///< one for each slot
  std::vector<PageResult> results_;   ///< one for each slot
};

}  // namespace clearway
