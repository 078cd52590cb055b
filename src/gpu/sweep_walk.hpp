#pragma once

#include <cstdint>

#include "core/sweep_ref.hpp"
#include "gpu/warp.hpp"

namespace clearway {

/// A lane's way through subtrees of the motion tree. It needs no stack: in preorder the subtree of
/// a range of n poses is a run of 2 n - 1 nodes.
struct SweepWay {
  std::uint32_t at = 0, end = 0;  ///< the node to look at, and the first behind the subtree
  std::uint32_t entered = 0;      ///< subtrees entered so far
  bool waits = false;             ///< for a search of the model at the single pose `at`

  CLEARWAY_HD bool is_inside() const { return at != end; }

  CLEARWAY_HD void enter(const MotionTreeRef& motion, std::uint32_t node) {
    at = node;
    end = node + 2 * motion.nodes[node].count - 1;
  }

  CLEARWAY_HD void leave_all(std::uint32_t count) {
    at = end = 0;
    entered = count;
  }
};

/// Subtrees that all lanes of a warp go through, each at its own pace.
struct SweepSubtrees {
  const std::uint32_t* nodes;
  std::uint32_t count;

  /// Enters the next subtree where the last one is done; false at the end.
  CLEARWAY_HD bool enter(const MotionTreeRef& motion, SweepWay& way) const {
    if (way.is_inside()) return true;
    if (way.entered == count) return false;
    way.enter(motion, nodes[way.entered++]);
    return true;
  }
};

/// The lanes' ways to their ends: step(lane, way) looks at a node and moves the way on or lets it
/// wait, defer(waiting lanes as bits) takes what waits off their hands where it can, search(lane,
/// way) searches the model at a single pose. Lanes that wait do so until all do, then search
/// together.
template <typename Warp, typename Step, typename Defer, typename Search>
CLEARWAY_HD void walk(const MotionTreeRef& motion, const SweepSubtrees& subtrees,
                      typename Warp::template PerLane<SweepWay>& ways, Step step, Defer defer,
                      Search search) {
  for (;;) {
    const std::uint32_t walking = Warp::ballot([&](std::uint32_t lane) {
      SweepWay& way = ways[lane];
      if (way.waits || !subtrees.enter(motion, way)) return false;
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
