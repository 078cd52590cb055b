#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/cloud/block_positions.hpp"
#include "core/sweep/field/field_lanes.hpp"
#include "core/sweep/sweep_filter.hpp"

namespace clearway {

/// Searches the points of a block together, on the host: every motion node is looked at for all
/// points that it may still matter to, in vectors of the processor. One thread uses it at a time.
template <typename Element>
class BlockDescentOf {
 public:
  /// filter: must outlive this object.
  explicit BlockDescentOf(const SweepFilterOf<Element>& filter)
      : filter_(filter), sweep_(filter.ref()), lanes_(sweep_.field) {}

  /// The points of the block, to be set before a search.
  BlockPositions& points() { return points_; }

  /// Those of `which`, as bits, that the model touches at a pose of `nodes` or, between poses, on
  /// the way from one of them to the next.
  std::uint64_t touches(std::uint64_t which, std::span<const std::uint32_t> nodes,
                        SweepStatistics& statistics);

  /// Finds the first pose (clearway/query.hpp) of each point of `searched`, as bits, or
  /// kNoPose. nodes: what SweepFilterOf::narrow() left of all nodes for the block, in the
  /// order of their poses. first_poses: an entry for each point of the block; others stay as they
  /// are. Returns the points that have a first pose, as bits.
  std::uint64_t find_first_poses(std::uint64_t searched, std::span<const std::uint32_t> nodes,
                                 std::span<std::uint32_t> first_poses, SweepStatistics& statistics);

  /// Greatest memory that it allocates, bytes. most_poses: greatest number of poses that `nodes`
  /// have together.
  static std::uint64_t most_bytes(std::uint64_t most_poses) {
    // A list may have grown to twice the size it needs.
    return kIsTriangle<Element> ? 2 * most_poses * sizeof(std::uint32_t) : 0;
  }

 private:
  void begin(std::uint64_t which, std::span<const std::uint32_t> nodes, bool first_pose,
             SweepStatistics& statistics);
  std::uint64_t look(std::uint32_t node, std::uint64_t which, double& squared_lower);
  void keep_hit(std::uint32_t point, std::uint32_t pose);
  void descend_nearer_first(std::uint32_t node, std::uint64_t which);
  void descend_in_order(std::uint32_t node, std::uint64_t which);
  void descend_one_by_one(std::uint32_t node, std::uint64_t which);
  void search_runs(std::uint32_t point);
  std::uint64_t wanted(std::uint32_t node, std::uint64_t which) const;

  const SweepFilterOf<Element>& filter_;
  const SweepRefOf<Element>& sweep_;
  BlockPositions points_;
  FieldLanes lanes_;

  // The search under way:
  std::uint64_t hits_ = 0;             ///< points that touch
  std::uint64_t finished_ = 0;         ///< points of which nothing more is to be found
  bool first_pose_ = false;            ///< whether first poses are searched
  std::uint32_t best_[kBlockPoints];   ///< first poses known
  std::uint64_t tests_[kBlockPoints];  ///< what a point has cost so far; for triangles
  std::span<const std::uint32_t> nodes_;
  std::vector<std::uint32_t> runs_;  ///< runs of poses, once a point grazes the model
  SweepStatistics* statistics_ = nullptr;
};

extern template class BlockDescentOf<Vec3>;
extern template class BlockDescentOf<Triangle>;
extern template class BlockDescentOf<SolidTriangle>;

}  // namespace clearway
