#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "core/page/page_engine.hpp"
#include "core/page/page_pool.hpp"
#include "core/sweep/profile/profile_walk.hpp"
#include "cpu/cell_search.hpp"

namespace clearway {

/// The sweep engine on the CPU. It descends a cell's implicit tree and the motion tree together,
/// down to points, each of which is decoded once. `start` searches in the thread that calls it.
template <typename Element>
class SweepEngineOf final : public PageEngine {
 public:
  /// Cloud and filter must outlive the engine. It allocates its slots; in addition it takes at most
  /// CellSearchOf::most_bytes and ProfileWalkOf::most_bytes for each thread that is in `start` at a
  /// time, and profile_bytes().
  /// in_place: whether coordinates are searched where the cloud has them, without a copy, which
  /// pays where they were read before.
  SweepEngineOf(const PackedCloud& cloud, const SweepFilterOf<Element>& filter,
                const SlotLayout& layout, bool in_place = false);

  std::uint32_t slots() const override { return pool_.layout().slots; }
  std::span<std::byte> page(std::uint32_t slot) override { return pool_.page(slot); }
  std::optional<CellPayload> kept(std::uint32_t slot, std::uint32_t cell) override;
  void start(std::uint32_t slot, const PageShape& shape) override;
  PageResult finish(std::uint32_t slot) override { return results_[slot]; }

  /// Greatest memory that a profile takes, bytes. most_poses: greatest number of poses that the
  /// nodes of a cell have together.
  static std::uint64_t profile_bytes(const PackedCloud& cloud, const Query& query,
                                     const SlotLayout& layout, std::uint64_t most_poses);

  /// Counts of all searches so far. Must not be called during a search.
  const SweepStatistics& statistics() const { return statistics_; }

 private:
  void search_profile(std::uint32_t slot, const PageRef& page);
  template <typename Search>
  std::unique_ptr<Search> take(std::vector<std::unique_ptr<Search>>& idle);
  template <typename Search>
  void give_back(std::unique_ptr<Search> search, std::vector<std::unique_ptr<Search>>& idle);

  const PackedCloud& cloud_;
  const SweepFilterOf<Element>& filter_;
  const bool in_place_;
  PagePool pool_;
  std::vector<PageResult> results_;              ///< one for each slot
  std::optional<ProfileBestValues> bests_;       ///< only with a profile
  std::vector<std::vector<ProfileFact>> facts_;  ///< one list for each slot; only with a profile
  std::mutex mutex_;
  /// Searches not in use; at most as many as threads were ever in start() at once
  std::vector<std::unique_ptr<CellSearchOf<Element>>> idle_;
  std::vector<std::unique_ptr<ProfileWalkOf<Element>>> idle_walks_;  ///< only with a profile
  SweepStatistics statistics_;
};

using SweepEngine = SweepEngineOf<Vec3>;

extern template class SweepEngineOf<Vec3>;
extern template class SweepEngineOf<Triangle>;
extern template class SweepEngineOf<SolidTriangle>;

}  // namespace clearway
