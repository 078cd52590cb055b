#pragma once

#include <cstdint>

#include "core/sweep/sweep_ref.hpp"
#include "core/util/bit_reversal_order.hpp"
#include "core/util/device_bits.hpp"
#include "core/util/warp.hpp"

namespace clearway {

/// Motion nodes whose subtrees all lanes of a warp work on.
struct SweepSubtrees {
  static constexpr std::uint32_t kMost = BitReversalOrder::kMost;

  const std::uint32_t* nodes;
  std::uint32_t count;  ///< at most kMost
};

/// A lane's way through its part of some subtrees. It needs no stack, because in preorder the
/// subtree of a range of n poses is a run of 2 n - 1 nodes.
struct SweepWay {
  std::uint64_t open = 0;         ///< subtrees still to be entered, as bits
  std::uint32_t at = 0, end = 0;  ///< the node to look at, and the first one after the subtree
  bool waits = false;  ///< whether the way waits for a search of the model at the single pose `at`

  CLEARWAY_HD bool is_inside() const { return at != end; }

  CLEARWAY_HD void enter(const MotionTreeRef& motion, std::uint32_t node) {
    at = node;
    end = node + 2 * motion.nodes[node].count - 1;
  }

  /// Enters a subtree below its top, which was looked at already; a single pose is looked at again.
  CLEARWAY_HD void enter_below(const MotionTreeRef& motion, std::uint32_t node) {
    enter(motion, node);
    if (end - at > 1) ++at;
  }

  /// Enters the next subtree if the last one is done. Returns false at the end.
  CLEARWAY_HD bool go_on(const MotionTreeRef& motion, const SweepSubtrees& subtrees) {
    if (is_inside()) return true;
    if (open == 0) return false;
    enter_below(motion, subtrees.nodes[lowest_bit(open)]);
    open &= open - 1;
    return true;
  }

  CLEARWAY_HD void leave_all() {
    open = 0;
    at = end = 0;
  }
};

/// Looks at the tops of the subtrees, all lanes at the same one, those far apart first, because
/// most points that collide do so at one of them. is_wanted(lane): whether the lane has anything to
/// find; look(lane, node): whether the subtree stays open.
template <typename Warp, typename IsWanted, typename Look>
CLEARWAY_HD void look_at_tops(const SweepSubtrees& subtrees,
                              typename Warp::template PerLane<SweepWay>& ways, IsWanted is_wanted,
                              Look look) {
  BitReversalOrder(subtrees.count).for_each([&](std::uint32_t i) {
    const std::uint32_t node = subtrees.nodes[i];
    const std::uint32_t wanted = Warp::ballot([&](std::uint32_t lane) {
      if (!is_wanted(lane)) return false;
      if (look(lane, node)) ways[lane].open |= std::uint64_t{1} << i;
      return true;
    });
    return wanted != 0;
  });
}

/// Walks all lanes to the ends of their ways, each at its own pace. step(lane, way) looks at a node
/// and moves the way on or lets it wait; defer(waiting lanes as bits) takes over the waiting
/// searches if it can; search(lane, node) searches the model at a single pose. Lanes that wait do
/// so until all lanes do, and then search together.
template <typename Warp, typename Step, typename Defer, typename Search>
CLEARWAY_HD void walk(const MotionTreeRef& motion, const SweepSubtrees& subtrees,
                      typename Warp::template PerLane<SweepWay>& ways, Step step, Defer defer,
                      Search search) {
  for (;;) {
    const std::uint32_t walking = Warp::ballot([&](std::uint32_t lane) {
      SweepWay& way = ways[lane];
      if (way.waits || !way.go_on(motion, subtrees)) return false;
      step(lane, way);
      return true;
    });
    const std::uint32_t waiting =
        Warp::ballot([&](std::uint32_t lane) { return ways[lane].waits; });
    if (walking == 0 && waiting == 0) return;
    if (waiting == 0) continue;
    const bool deferred = defer(waiting);
    if (!deferred && walking != 0) continue;
    Warp::each([&](std::uint32_t lane) {
      SweepWay& way = ways[lane];
      if (!way.waits) return;
      way.waits = false;
      if (!deferred) search(lane, way.at);
      if (way.is_inside()) ++way.at;
    });
  }
}

}  // namespace clearway
