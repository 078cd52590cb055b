#pragma once

#include <cstdint>
#include <vector>

#include "core/cloud/packed_cloud.hpp"
#include "core/sweep/profile/profile_search.hpp"
#include "core/sweep/sweep_filter.hpp"

namespace clearway {

/// The values that ProfileBests refers to, as they are at the begin of a search.
class ProfileBestValues {
 public:
  template <typename Element>
  explicit ProfileBestValues(const SweepRefOf<Element>& sweep)
      : ProfileBestValues(sweep.profile, sweep.rounding, sweep.motion.pose_count) {}

  ProfileBests ref() { return {limit_, of_pose_.data(), of_node_.data()}; }

  static std::uint64_t size_bytes(std::uint64_t poses) { return 3 * poses * sizeof(double); }

 private:
  ProfileBestValues(double profile, double rounding, std::size_t poses);

  double limit_;
  std::vector<double> of_pose_, of_node_;
};

/// Of points with the same d2 keeps the one with the smallest source.
class SmallestSource {
 public:
  SmallestSource(const PackedCloud& cloud, std::vector<ProfileFact>& found)
      : cloud_(cloud), found_(found) {}

  void enter_cell(std::uint32_t index, const PageCell& cell) {
    cell_ = cell.cell;
    first_slot_ = index * cloud_.cell_entries();
  }
  void restart() { source_ = ~std::uint64_t{0}; }
  void add(std::uint32_t first, std::uint32_t bits);
  void keep(std::uint32_t pose, double squared) { found_.push_back({squared, pose, point_, 0}); }

 private:
  const PackedCloud& cloud_;
  std::vector<ProfileFact>& found_;
  std::uint32_t cell_ = 0, first_slot_ = 0;
  std::uint32_t point_ = 0;
  std::uint64_t source_ = ~std::uint64_t{0};
};

/// The profile's search on the host, with the lanes of a warp as a loop.
template <typename Element>
class HostProfileOf {
 public:
  /// All outlive it.
  HostProfileOf(const PackedCloud& cloud, const SweepRefOf<Element>& sweep)
      : cloud_(cloud), sweep_(sweep) {}

  /// Appends to `found` what the cells of a page have that no other point known is better than.
  void search(const PageRef& page, const ProfileBests& bests, std::vector<ProfileFact>& found);

  /// Finds the point with the smallest source among those of the fact's cell with the same d2.
  void resolve(const PageRef& page, double limit, ProfileFact& fact);

  /// Of what a device listed of a page keeps the best and resolves ties. A point that is far from
  /// the best may be replaced by none.
  void complete(const PageRef& page, std::vector<ProfileFact>& facts);

  SweepStatistics take_statistics();

  /// Of a page of so many cells, none of whose nodes have more than `poses_of_cell` poses.
  static std::uint64_t most_facts(const PackedCloud& cloud, std::uint64_t poses,
                                  std::uint64_t cells, std::uint64_t poses_of_cell);

 private:
  using Search = ProfileSearch<HostWarp, SmallestSource, Element>;

  /// Of each pose those facts that no other betters; one_each: of several the one with the smallest
  /// source.
  void keep_least(const PageRef& page, bool one_each, std::vector<ProfileFact>& facts) const;

  const PackedCloud& cloud_;
  const SweepRefOf<Element>& sweep_;
  HostWarp::PerLane<SweepStatistics> statistics_;
};

using HostProfile = HostProfileOf<Vec3>;

extern template class HostProfileOf<Vec3>;
extern template class HostProfileOf<Triangle>;
extern template class HostProfileOf<SolidTriangle>;

}  // namespace clearway
