#pragma once

#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

#include "core/page/page_engine.hpp"
#include "core/page/page_pool.hpp"
#include "core/sweep/profile/host_profile.hpp"
#include "core/sweep/profile/profile_page.hpp"
#include "core/sweep/sweep_block.hpp"

namespace clearway {

/// Runs the bodies of the CUDA sweep engine's kernels in their order on the CPU, with a loop over
/// the lanes of a warp.
template <typename Element>
class HostSweepOf final : public PageEngine {
 public:
  /// entries: how many entries fit on each list of open work.
  HostSweepOf(const PackedCloud& cloud, const SweepRefOf<Element>& sweep, const SlotLayout& layout,
              std::uint32_t entries)
      : sweep_(sweep),
        quantisation_(cloud.quantisation()),
        pool_(cloud, query_of(sweep), layout),
        results_(layout.slots),
        entries_(entries),
        profile_(cloud, sweep_),
        bests_(sweep_),
        facts_(layout.slots) {}

  std::uint32_t slots() const override { return pool_.layout().slots; }
  std::span<std::byte> page(std::uint32_t slot) override { return pool_.page(slot); }
  PageResult finish(std::uint32_t slot) override { return results_[slot]; }

  void start(std::uint32_t slot, const PageShape& shape) override {
    SweepPageOf<Element> job{.sweep = sweep_,
                             .page = {pool_.page(slot).data(), shape},
                             .quantisation = quantisation_,
                             .hits = pool_.hits(slot).data(),
                             .first_poses = pool_.first_poses(slot).data(),
                             .clearances = pool_.clearances(slot).data(),
                             .work = {}};
    const std::uint32_t blocks = job.block_count();
    std::vector<std::uint32_t> nodes(2 * std::size_t{entries_});
    std::vector<SweepWork::Entry> entries(entries_ + 2 * blocks);
    std::vector<SweepWork::Item> walks(entries_), items(entries_);
    SweepWork::Counts counts{};
    job.work = {nodes.data(), entries.data(), walks.data(), items.data(), &counts,
                2 * entries_, entries_,       entries_,     entries_};
    run(job);
    results_[slot] = pool_.result(slot, shape.cells);
    if (sweep_.profile > 0) search_profile(slot, job);
  }

 private:
  /// Searches the profile as on a device, where the list of facts may be too short; then the host
  /// searches the page anew.
  void search_profile(std::uint32_t slot, const SweepPageOf<Element>& job) {
    std::vector<ProfileFact>& facts = facts_[slot];
    facts.assign(entries_, {});
    ProfileCounts counts{};
    const ProfileList list{facts.data(), &counts, entries_};
    HostWarp::PerLane<SweepStatistics> statistics;
    typename ProfileTask<HostWarp, Element>::Shared shared;
    for (std::uint32_t task = 0; task < ProfileTask<HostWarp, Element>::count(job.page.shape);
         ++task) {
      ProfileTask<HostWarp, Element>(job, bests_.ref(), list, shared, statistics).search(task);
    }
    const std::lock_guard lock(mutex_);
    if (counts.facts > entries_) {
      facts.clear();
      profile_.search(job.page, bests_.ref(), facts);
    } else {
      facts.resize(counts.facts);
      profile_.complete(job.page, facts);
    }
    results_[slot].profile = facts;
  }

  static Query query_of(const SweepRefOf<Element>& sweep) {
    Query query;
    query.first_pose = sweep.first_pose;
    query.clearance = sweep.clearance;
    return query;
  }

  static void run(const SweepPageOf<Element>& job) {
    HostWarp::PerLane<SweepStatistics> statistics;
    for (std::uint32_t block = 0; block < job.block_count(); ++block) {
      if (job.clearances != nullptr) {
        typename SweepBlock<HostWarp, true, Element>::Shared shared;
        SweepBlock<HostWarp, true, Element>(job, block, shared, statistics).search();
      } else {
        typename SweepBlock<HostWarp, false, Element>::Shared shared;
        SweepBlock<HostWarp, false, Element>(job, block, shared, statistics).search();
      }
    }
    for (std::uint32_t i = 0; i < job.work.entry_count(); ++i) {
      search_entry<HostWarp>(job, job.work.entry(i), statistics);
    }
    for (std::uint32_t i = 0; i < job.work.walk_count(); i += kWarpLanes) {
      SweepHits<HostWarp, Element>(job, statistics).search_walks(i, job.work.walk_count());
    }
    for (std::uint32_t i = 0; i < job.work.item_count(); ++i) {
      search_item(job, job.work.items[i], statistics[0]);
    }
  }

  SweepRefOf<Element> sweep_;
  Quantisation quantisation_;
  PagePool pool_;
  std::vector<PageResult> results_;
  std::uint32_t entries_;
  HostProfileOf<Element> profile_;
  ProfileBestValues bests_;
  std::vector<std::vector<ProfileFact>> facts_;  ///< the facts of each slot
  std::mutex mutex_;
};

}  // namespace clearway
