#pragma once

#include <cstdint>
#include <type_traits>
#include <vector>

#include "core/cloud/packed_cloud.hpp"
#include "core/sweep/profile/host_profile.hpp"
#include "core/sweep/profile/profile_depths.hpp"
#include "core/sweep/profile/profile_search.hpp"
#include "core/sweep/profile/profile_travel.hpp"
#include "core/sweep/sweep_filter.hpp"

namespace clearway {

/// The profile's search on the CPU. It takes the poses of a cell in their order. Every block and
/// every point keeps the distance that was last proven for it, and is looked at again only when the
/// model may have moved so far that it matters (docs/design/numerics.md, "Profile"). One thread
/// uses it at a time.
template <typename Element>
class ProfileWalkOf {
 public:
  /// Cloud and filter must outlive this object; the filter's query has a profile.
  ProfileWalkOf(const PackedCloud& cloud, const SweepFilterOf<Element>& filter);

  /// Appends to `found` the points of a page that are at least as near as any known point of their
  /// pose.
  void search(const PageRef& page, const ProfileBests& bests, std::vector<ProfileFact>& found);

  /// Counts of the searches since the last call.
  SweepStatistics take_statistics();

  /// Greatest memory that it allocates, bytes. most_poses: greatest number of poses that the nodes
  /// of a cell have together.
  static std::uint64_t most_bytes(const PackedCloud& cloud, const Query& query,
                                  std::uint64_t most_poses);

 private:
  using Blocks = ProfileBlocks<HostWarp, Element>;
  using Depths = std::conditional_t<kIsSolid<Element>,
                                    ProfileDepths<HostWarp, SmallestSource, Element>, NoDepths>;
  class OfPage;

  /// So many steps from pose to pose are at least half the diagonal of a cell where poses are far
  /// apart.
  static constexpr double kFarSteps = 4;
  bool is_far_apart(const PageCell& cell, std::uint32_t top) const;

  /// A block of the part of a cell under search. A key is a proven distance from the model plus the
  /// way moved until it was proven: what has it cannot matter before a pose's reach plus the way
  /// moved until there exceed it.
  struct Block {
    Vec3 centre;
    double rho;            ///< no point of the block is farther than this from the centre
    double key;            ///< no point that is awake has a smaller one, unless it is the sphere's
    std::uint64_t awake;   ///< points that are searched and not asleep, as bits
    std::uint64_t asleep;  ///< points that lie below the floor until a later pose, as bits
    std::uint32_t wakes;   ///< the pose for which the block is on the list of sleepers, or kNever
    std::uint32_t looked_at;  ///< the last pose at which the block's sphere was looked at
    bool is_open;             ///< whether its points have keys of their own
  };
  /// The stored coordinates of an open block.
  struct StoredBlock {
    std::int32_t at[3][kBlockPoints];
  };
  /// The poses and blocks at which points, or blocks as a whole, wake.
  struct Sleeper {
    std::uint32_t pose, block;
    friend bool operator>(const Sleeper& a, const Sleeper& b) { return a.pose > b.pose; }
  };
  struct Queued {
    double key;
    std::uint32_t block;
    friend bool operator>(const Queued& a, const Queued& b) { return a.key > b.key; }
  };

  const PackedCloud& cloud_;
  const SweepFilterOf<Element>& filter_;
  HostWarp::PerLane<SweepStatistics> statistics_;
  // The memory of a part of a cell:
  std::vector<Block> blocks_;
  std::vector<double> keys_;  ///< 64 for each block; infinite if not awake
  std::vector<StoredBlock> stored_;
  std::vector<std::uint32_t> wakes_;    ///< 64 for each block; only with a floor
  std::vector<Queued> queue_;           ///< a heap, least key first; may hold outdated entries
  std::vector<Sleeper> sleepers_;       ///< a heap, first pose first
  std::vector<std::uint32_t> settled_;  ///< blocks that a pose needs no more
  std::vector<std::uint32_t> visited_;  ///< inner motion nodes that were not passed over
};

extern template class ProfileWalkOf<Vec3>;
extern template class ProfileWalkOf<Triangle>;
extern template class ProfileWalkOf<SolidTriangle>;

}  // namespace clearway
