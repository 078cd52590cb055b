#pragma once

#include <cstdint>

#include "core/sweep/profile/profile_search.hpp"

namespace clearway {

/// Searches the profile of a page on a device, by one warp, in tasks of about the same size: a task
/// is one of kNodeParts parts of a planned motion node against a part of its cell.
template <typename Warp, typename Element = Vec3>
class ProfileTask {
 public:
  template <typename Value>
  using PerLane = typename Warp::template PerLane<Value>;
  using Search = ProfileSearch<Warp, UnresolvedTies, Element>;
  using Shared = typename Search::Shared;

  CLEARWAY_HD ProfileTask(const SweepPageOf<Element>& job, const ProfileBests& bests,
                          const ProfileList& list, Shared& shared,
                          PerLane<SweepStatistics>& statistics)
      : page_(job.page),
        motion_(job.sweep.motion),
        search_(job.sweep, job.page, job.quantisation, bests, UnresolvedTies(list), shared,
                statistics) {}

  CLEARWAY_HD static std::uint64_t count(const PageShape& shape) {
    return std::uint64_t{shape.nodes} * Search::parts_of_cell(shape.blocks_per_cell) * kNodeParts;
  }

  CLEARWAY_HD void search(std::uint64_t task) {
    const auto node_part = static_cast<std::uint32_t>(task % kNodeParts);
    const std::uint32_t cell_parts = Search::parts_of_cell(page_.shape.blocks_per_cell);
    const auto part = static_cast<std::uint32_t>(task / kNodeParts % cell_parts);
    const auto listed = static_cast<std::uint32_t>(task / kNodeParts / cell_parts);
    const std::uint32_t cell = cell_of_node(listed);
    const PageCell& searched = page_.cell(cell);
    if (listed - searched.first_node >= searched.node_count) return;  // planned for another body
    const std::uint32_t planned = page_.nodes(searched)[listed - searched.first_node];
    std::uint32_t node = 0;
    if (part_of_node(planned, node_part, node) && search_.enter(cell, part)) search_.search(node);
  }

 private:
  static constexpr std::uint32_t kNodeLevels = 3;
  static constexpr std::uint32_t kNodeParts = 1U << kNodeLevels;

  /// The cell among whose planned nodes an entry of the page's node list is, if it is in any.
  CLEARWAY_HD std::uint32_t cell_of_node(std::uint32_t listed) const {
    std::uint32_t begin = 0, end = page_.shape.cells;
    while (end - begin > 1) {
      const std::uint32_t middle = begin + (end - begin) / 2;
      (page_.cell(middle).first_node <= listed ? begin : end) = middle;
    }
    return begin;
  }

  /// Finds the descendant kNodeLevels below a planned node that is this part. A single pose above
  /// that level belongs to its first part only. Returns whether the part exists.
  CLEARWAY_HD bool part_of_node(std::uint32_t planned, std::uint32_t part,
                                std::uint32_t& node) const {
    node = planned;
    for (std::uint32_t left = part, level = 0; level < kNodeLevels; ++level, left >>= 1) {
      if (motion_.nodes[node].count == 1) return left == 0;
      node = (left & 1) != 0 ? motion_.nodes[node].later : node + 1;
    }
    return true;
  }

  const PageRef& page_;
  const MotionTreeRef& motion_;
  Search search_;
};

}  // namespace clearway
