#include "cpu/sweep_engine.hpp"

#include <algorithm>

#include "core/cloud/packed_cloud.hpp"

namespace clearway {
template <typename Element>
SweepEngineOf<Element>::SweepEngineOf(const PackedCloud& cloud,
                                      const SweepFilterOf<Element>& filter,
                                      const SlotLayout& layout, bool in_place)
    : cloud_(cloud),
      filter_(filter),
      in_place_(in_place),
      pool_(cloud, filter.query(), layout),
      results_(layout.slots) {
  if (!(filter.ref().profile > 0)) return;
  bests_.emplace(filter.ref());
  facts_.resize(layout.slots);
}

template <typename Element>
std::optional<CellPayload> SweepEngineOf<Element>::kept(std::uint32_t slot, std::uint32_t cell) {
  if (!in_place_) return std::nullopt;
  const auto packed = cloud_.in_place(cell);
  if (!packed) return std::nullopt;
  return payload_at(*packed, pool_.page(slot).data());
}

template <typename Element>
void SweepEngineOf<Element>::start(std::uint32_t slot, const PageShape& shape) {
  const Clock::time_point begin = Clock::now();
  const PageRef page{pool_.page(slot).data(), shape};
  const std::size_t blocks = cloud_.blocks_per_cell(), slots = cloud_.cell_entries();
  std::unique_ptr<CellSearchOf<Element>> search = take(idle_);
  for (std::uint32_t i = 0; i < shape.cells; ++i) {
    search->run(
        page, i,
        {part_of_cell(pool_.hits(slot), i, blocks), part_of_cell(pool_.first_poses(slot), i, slots),
         part_of_cell(pool_.clearances(slot), i, slots)});
  }
  give_back(std::move(search), idle_);
  results_[slot] = pool_.result(slot, shape.cells);
  if (bests_) search_profile(slot, page);
  results_[slot].compute = {begin, Clock::now()};
}

template <typename Element>
void SweepEngineOf<Element>::search_profile(std::uint32_t slot, const PageRef& page) {
  std::uint64_t most_poses = 0;
  for (std::uint32_t i = 0; i < page.shape.cells; ++i) {
    const PageCell& cell = page.cell(i);
    const std::span nodes(page.nodes(cell), cell.node_count);
    most_poses = std::max(most_poses, pose_count(filter_.motion(), nodes));
  }
  const std::uint64_t most = HostProfileOf<Element>::most_facts(
      cloud_, filter_.motion().poses().size(), page.shape.cells, most_poses);
  std::vector<ProfileFact>& facts = facts_[slot];
  facts.clear();
  if (facts.capacity() < most) facts = {};
  facts.reserve(most);
  std::unique_ptr<ProfileWalkOf<Element>> walk = take(idle_walks_);
  walk->search(page, bests_->ref(), facts);
  give_back(std::move(walk), idle_walks_);
  results_[slot].profile = facts;
}

template <typename Element>
std::uint64_t SweepEngineOf<Element>::profile_bytes(const PackedCloud& cloud, const Query& query,
                                                    const SlotLayout& layout,
                                                    std::uint64_t most_poses) {
  if (!(query.profile > 0)) return 0;
  return ProfileBestValues::size_bytes(query.poses.size()) +
         layout.slots *
             HostProfileOf<Element>::most_facts(cloud, query.poses.size(), layout.cells,
                                                most_poses) *
             sizeof(ProfileFact);
}

template <typename Element>
template <typename Search>
std::unique_ptr<Search> SweepEngineOf<Element>::take(std::vector<std::unique_ptr<Search>>& idle) {
  {
    const std::lock_guard lock(mutex_);
    if (!idle.empty()) {
      std::unique_ptr<Search> search = std::move(idle.back());
      idle.pop_back();
      return search;
    }
  }
  return std::make_unique<Search>(cloud_, filter_);
}

template <typename Element>
template <typename Search>
void SweepEngineOf<Element>::give_back(std::unique_ptr<Search> search,
                                       std::vector<std::unique_ptr<Search>>& idle) {
  const std::lock_guard lock(mutex_);
  statistics_.add(search->take_statistics());
  idle.push_back(std::move(search));
}

template class SweepEngineOf<Vec3>;
template class SweepEngineOf<Triangle>;
template class SweepEngineOf<SolidTriangle>;

}  // namespace clearway
