#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "core/page/page_engine.hpp"
#include "core/page/page_pool.hpp"
#include "core/sweep/profile/host_profile.hpp"
#include "cpu/cell_search.hpp"

namespace clearway {

/// The sweep engine on the CPU: descends a cell's implicit tree and the motion tree together, down
/// to points, each decoded once. `start` searches, in the thread that calls it.
template <typename Element>
class SweepEngineOf final : public PageEngine {
 public:
  /// The cloud and the filter outlive it. Allocates its slots; beside them, at the most
  /// CellSearchOf::most_bytes for each thread that is in `start` at a time, and profile_bytes().
  SweepEngineOf(const PackedCloud& cloud, const SweepFilterOf<Element>& filter,
                const SlotLayout& layout);

  std::uint32_t slots() const override { return pool_.layout().slots; }
  std::span<std::byte> page(std::uint32_t slot) override { return pool_.page(slot); }
  void start(std::uint32_t slot, const PageShape& shape) override;
  PageResult finish(std::uint32_t slot) override { return results_[slot]; }

  /// What a profile takes at the most; most_poses: of the nodes of any cell.
  static std::uint64_t profile_bytes(const PackedCloud& cloud, const Query& query,
                                     const SlotLayout& layout, std::uint64_t most_poses);

  /// Of all searches so far. Not during one.
  const SweepStatistics& statistics() const { return statistics_; }

 private:
  void search_profile(std::uint32_t slot, const PageRef& page);
  std::unique_ptr<CellSearchOf<Element>> take_search();
  void give_back(std::unique_ptr<CellSearchOf<Element>> search);

  const PackedCloud& cloud_;
  const SweepFilterOf<Element>& filter_;
  PagePool pool_;
  std::vector<PageResult> results_;              ///< by slot
  std::optional<ProfileBestValues> bests_;       ///< with a profile
  std::vector<std::vector<ProfileFact>> facts_;  ///< likewise, by slot
  std::mutex mutex_;
  std::vector<std::unique_ptr<CellSearchOf<Element>>>
      idle_;  ///< no more than threads were ever in start
  SweepStatistics statistics_;
};

using SweepEngine = SweepEngineOf<Vec3>;

extern template class SweepEngineOf<Vec3>;
extern template class SweepEngineOf<Triangle>;
extern template class SweepEngineOf<SolidTriangle>;

}  // namespace clearway
