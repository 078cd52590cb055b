#include "core/sweep/profile/host_profile.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

namespace clearway {
ProfileBestValues::ProfileBestValues(double profile, double rounding, std::size_t poses)
    : limit_(rounded_product(profile, profile)),
      of_pose_(poses, limit_),
      of_node_(poses == 0 ? 0 : 2 * poses - 1, std::sqrt(limit_) * kRoundedUp + rounding) {}

void SmallestSource::add(std::uint32_t first, std::uint32_t bits) {
  for (; bits != 0; bits &= bits - 1) {
    const std::uint32_t point = first + lowest_bit(bits);
    const std::uint64_t source = cloud_.source_of(cell_, point - first_slot_);
    if (source >= source_) continue;
    source_ = source;
    point_ = point;
  }
}

void keep_least_facts(const PackedCloud& cloud, const PageRef& page, bool one_each,
                      std::vector<ProfileFact>& facts) {
  std::sort(facts.begin(), facts.end(), [](const ProfileFact& a, const ProfileFact& b) {
    return std::tie(a.pose, a.squared, a.point) < std::tie(b.pose, b.squared, b.point);
  });
  const auto source_of = [&](const ProfileFact& fact) {
    const std::uint32_t entries = cloud.cell_entries();
    return cloud.source_of(page.cell(fact.point / entries).cell, fact.point % entries);
  };
  std::size_t kept = 0;
  for (const ProfileFact& fact : facts) {
    ProfileFact* const best = kept > 0 ? &facts[kept - 1] : nullptr;
    const bool is_first = best == nullptr || best->pose != fact.pose;
    if (!is_first && best->squared < fact.squared) continue;
    if (is_first || !one_each) {
      facts[kept++] = fact;
    } else if (source_of(fact) < source_of(*best)) {
      *best = fact;
    }
  }
  facts.resize(kept);
}

template <typename Element>
void HostProfileOf<Element>::search(const PageRef& page, const ProfileBests& bests,
                                    std::vector<ProfileFact>& found) {
  typename Search::Shared shared;
  const Quantisation& quantisation = cloud_.quantisation();
  Search search(sweep_, page, quantisation, bests, SmallestSource(cloud_, found), shared,
                statistics_);
  const std::uint32_t parts = Search::parts_of_cell(page.shape.blocks_per_cell);
  for (std::uint32_t i = 0; i < page.shape.cells; ++i) {
    const PageCell& cell = page.cell(i);
    for (std::uint32_t part = 0; part < parts && search.enter(i, part); ++part) {
      for (std::uint32_t node = 0; node < cell.node_count; ++node) {
        search.search(page.nodes(cell)[node]);
      }
    }
    if (page.shape.cells > 1) keep_least_facts(cloud_, page, true, found);
  }
}

template <typename Element>
void HostProfileOf<Element>::resolve(const PageRef& page, double limit, ProfileFact& fact) {
  const ProfileBests bests{limit, nullptr, nullptr};
  typename Search::Shared shared;
  std::vector<ProfileFact> found;
  const Quantisation& quantisation = cloud_.quantisation();
  Search search(sweep_, page, quantisation, bests, SmallestSource(cloud_, found), shared,
                statistics_);
  const std::uint32_t cell = fact.point / cloud_.cell_entries();
  const std::uint32_t index = fact.point % cloud_.cell_entries();
  if (!search.enter(cell, index / kBlockPoints / Search::Blocks::kPartBlocks)) return;
  search.search_pose(fact.pose, fact.squared);
  if (!found.empty()) fact = found.front();
}

template <typename Element>
void HostProfileOf<Element>::complete(const PageRef& page, std::vector<ProfileFact>& facts) {
  keep_least_facts(cloud_, page, false, facts);
  const double limit = rounded_product(sweep_.profile, sweep_.profile);
  for (ProfileFact& fact : facts) {
    if (fact.tied != 0) resolve(page, limit, fact);
  }
}

template <typename Element>
SweepStatistics HostProfileOf<Element>::take_statistics() {
  SweepStatistics sum;
  for (SweepStatistics& of_lane : statistics_.values) sum.add(std::exchange(of_lane, {}));
  return sum;
}

template <typename Element>
std::uint64_t HostProfileOf<Element>::most_facts(const PackedCloud& cloud, std::uint64_t poses,
                                                 std::uint64_t cells, std::uint64_t poses_of_cell) {
  const std::uint64_t of_cell =
      Search::parts_of_cell(cloud.blocks_per_cell()) * poses_of_cell;  // one for each pose and part
  return std::min(cells * of_cell, poses + of_cell);
}

template class HostProfileOf<Vec3>;
template class HostProfileOf<Triangle>;
template class HostProfileOf<SolidTriangle>;

}  // namespace clearway
