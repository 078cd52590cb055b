#pragma once

#include <cstdint>
#include <vector>

#include "core/cloud/packed_cloud.hpp"
#include "core/sweep/profile/profile_search.hpp"
#include "core/sweep/sweep_filter.hpp"

namespace clearway {

/// Owner of the values that ProfileBests refers to, with their values at the beginning of a search.
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

/// Policy for ties: of points with the same d2 it keeps the one with the smallest source index.
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

/// Keeps, for each pose, the facts of a page that no other fact betters. one_each: keeps only the
/// fact with the smallest source index.
void keep_least_facts(const PackedCloud& cloud, const PageRef& page, bool one_each,
                      std::vector<ProfileFact>& facts);

/// On the host the search that a GPU makes for a profile, for what does not fit there; the lanes of
/// a warp are a loop. A search on the CPU alone is ProfileWalkOf.
template <typename Element>
class HostProfileOf {
 public:
  /// cloud and sweep must outlive this object.
  HostProfileOf(const PackedCloud& cloud, const SweepRefOf<Element>& sweep)
      : cloud_(cloud), sweep_(sweep) {}

  /// Appends to `found` the points of a page that are at least as near as any known point of their
  /// pose.
  void search(const PageRef& page, const ProfileBests& bests, std::vector<ProfileFact>& found);

  /// Replaces a fact's point with the one of smallest source index among the points of its cell
  /// that have the same d2.
  void resolve(const PageRef& page, double limit, ProfileFact& fact);

  /// Completes the facts that a device listed for a page: keeps the best ones of each pose and
  /// resolves ties.
  void complete(const PageRef& page, std::vector<ProfileFact>& facts);

  SweepStatistics take_statistics();

  /// Greatest number of facts for a page of `cells` cells, if the nodes of a cell have at most
  /// `poses_of_cell` poses.
  static std::uint64_t most_facts(const PackedCloud& cloud, std::uint64_t poses,
                                  std::uint64_t cells, std::uint64_t poses_of_cell);

 private:
  using Search = ProfileSearch<HostWarp, SmallestSource, Element>;

  const PackedCloud& cloud_;
  const SweepRefOf<Element>& sweep_;
  HostWarp::PerLane<SweepStatistics> statistics_;
};

using HostProfile = HostProfileOf<Vec3>;

extern template class HostProfileOf<Vec3>;
extern template class HostProfileOf<Triangle>;
extern template class HostProfileOf<SolidTriangle>;

}  // namespace clearway
