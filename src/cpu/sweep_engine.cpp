#include "cpu/sweep_engine.hpp"

#include <algorithm>

#include "core/cloud/kd_order.hpp"

namespace clearway {
SweepEngine::SweepEngine(const PackedCloud& cloud, const SweepFilter& filter,
                         const SlotLayout& layout)
    : cloud_(cloud), filter_(filter), pool_(cloud, filter.query(), layout), results_(layout.slots) {
  if (!(filter.ref().profile > 0)) return;
  bests_.emplace(filter.ref());
  facts_.resize(layout.slots);
}

void SweepEngine::start(std::uint32_t slot, const PageShape& shape) {
  const Clock::time_point begin = Clock::now();
  const PageRef page{pool_.page(slot).data(), shape};
  const std::size_t blocks = cloud_.blocks_per_cell(), slots = cloud_.cell_entries();
  std::unique_ptr<CellSearch> search = take_search();
  for (std::uint32_t i = 0; i < shape.cells; ++i) {
    search->run(
        page, i,
        {part_of_cell(pool_.hits(slot), i, blocks), part_of_cell(pool_.first_poses(slot), i, slots),
         part_of_cell(pool_.clearances(slot), i, slots)});
  }
  give_back(std::move(search));
  results_[slot] = pool_.result(slot, shape.cells);
  if (bests_) search_profile(slot, page);
  results_[slot].compute = {begin, Clock::now()};
}

void SweepEngine::search_profile(std::uint32_t slot, const PageRef& page) {
  std::uint64_t most_poses = 0;
  for (std::uint32_t i = 0; i < page.shape.cells; ++i) {
    const PageCell& cell = page.cell(i);
    const std::span nodes(page.nodes(cell), cell.node_count);
    most_poses = std::max(most_poses, pose_count(filter_.motion(), nodes));
  }
  const std::uint64_t most = HostProfile::most_facts(cloud_, filter_.motion().poses().size(),
                                                     page.shape.cells, most_poses);
  std::vector<ProfileFact>& facts = facts_[slot];
  facts.clear();
  if (facts.capacity() < most) facts = {};
  facts.reserve(most);
  HostProfile search(cloud_, filter_.ref());
  search.search(page, bests_->ref(), facts);
  results_[slot].profile = facts;
  const std::lock_guard lock(mutex_);
  statistics_.add(search.take_statistics());
}

std::uint64_t SweepEngine::profile_bytes(const PackedCloud& cloud, const Query& query,
                                         const SlotLayout& layout, std::uint64_t most_poses) {
  if (!(query.profile > 0)) return 0;
  return ProfileBestValues::size_bytes(query.poses.size()) +
         layout.slots *
             HostProfile::most_facts(cloud, query.poses.size(), layout.cells, most_poses) *
             sizeof(ProfileFact);
}

std::unique_ptr<CellSearch> SweepEngine::take_search() {
  const std::lock_guard lock(mutex_);
  if (idle_.empty()) return std::make_unique<CellSearch>(cloud_, filter_);
  std::unique_ptr<CellSearch> search = std::move(idle_.back());
  idle_.pop_back();
  return search;
}

void SweepEngine::give_back(std::unique_ptr<CellSearch> search) {
  const std::lock_guard lock(mutex_);
  statistics_.add(search->take_statistics());
  idle_.push_back(std::move(search));
}

}  // namespace clearway
