#pragma once

#include <cmath>
#include <cstdint>

#include "core/sweep/sweep_ref.hpp"

namespace clearway {

/// How deep e lies inside at a pose: the square of the depth, as the greatest of the solids that
/// contain e of the least d2 to their triangles; 0 where none does.
template <typename Element>
CLEARWAY_HD double squared_depth(const SweepRefOf<Element>& sweep, const Vec3& e,
                                 std::uint32_t pose_index, SweepStatistics& statistics) {
  const Pose& pose = sweep.motion.poses[pose_index];
  const SolidPartsRef& solids = sweep.field.inside.solids;
  const Vec3 x = pulled_back(pose, e);
  double deepest = 0;
  solids.any_with(
      [&](std::uint32_t solid) {
        ++statistics.exact_tests;
        const SolidPartsRef::Tree tree = solids.tree(solid);
        double least = kInfinity, ball = kInfinity;
        const auto offer = [&](const Triangle& t) {
          const double squared = squared_distance(e, transform(pose, t));
          if (!(squared < least)) return;
          least = squared;
          // Triangles beyond it, seen from x, have only larger d2 at the pose.
          const double reach = (std::sqrt(least) * kRoundedUp + sweep.rounding) /
                               sweep.motion.inverse_poses[pose_index].least * kRoundedUp;
          ball = reach * reach * kRoundedUp;
        };
        offer(tree.elements[tree.nearest(x, 0).element]);
        tree.any(
            [&](const Box& box) {
              return least_squared_distance(box, x) > ball ? ModelStep::kSkip : ModelStep::kEnter;
            },
            [&](const Triangle& t) {
              if (!(squared_distance(x, t) > ball)) offer(t);
              return false;
            });
        deepest = greater_of(deepest, least);
        return false;
      },
      x);
  return deepest;
}

/// The greatest depth of one environment point: branch and bound over the motion tree. What is
/// given up is proven to have only computed depths below the best so far, so that ties reach the
/// lowest pose (docs/design/numerics.md, "Solids").
template <typename Element>
class SolidDepth {
 public:
  /// best: known so far, of which only what is inside counts.
  CLEARWAY_HD SolidDepth(const SweepRefOf<Element>& sweep, const Vec3& e, const Clearance& best,
                         SweepStatistics& statistics)
      : sweep_(sweep), statistics_(statistics), e_(e) {
    if (best.squared < 0) best_ = best;
  }

  /// Below 0, where the point was inside at any pose; otherwise 0.
  CLEARWAY_HD const Clearance& best() const { return best_; }

  /// Every pose of a node of the motion tree.
  CLEARWAY_HD void search(std::uint32_t top) {
    const std::uint32_t end = top + size_of(top);
    for (std::uint32_t at = top; at < end;) at += is_done(at) ? size_of(at) : 1;
  }

  /// Looks at one pose. How deep the point lies there, at the least 0.
  CLEARWAY_HD double offer(std::uint32_t pose) {
    const double squared = squared_depth(sweep_, e_, pose, statistics_);
    if (squared > -best_.squared || (squared == -best_.squared && pose < best_.pose)) {
      best_ = {0 - squared, pose};
    }
    return std::sqrt(squared);
  }

 private:
  CLEARWAY_HD std::uint32_t size_of(std::uint32_t at) const {
    return 2 * sweep_.motion.nodes[at].count - 1;
  }

  /// Whether the poses below a node need no look. No pose of it has a greater depth than its middle
  /// one by more than delta.
  CLEARWAY_HD bool is_done(std::uint32_t at) {
    ++statistics_.point_tests;
    const MotionNode& node = sweep_.motion.nodes[at];
    const InversePose& back = sweep_.motion.inverse_poses[node.mid];
    const Vec3 x = back.apply(e_);
    const double squared_lower = sweep_.field.bounds(x).squared_lower;
    const bool is_same = farther(back.least, squared_lower, node.delta + sweep_.rounding);
    if (is_same && !sweep_.is_inside(x, squared_lower)) return true;
    const double depth = offer(node.mid);
    if (node.count == 1) return true;
    const double most = (depth + node.delta + 2 * sweep_.rounding) * kRoundedUp;
    return most * most * kRoundedUp < -best_.squared;
  }

  const SweepRefOf<Element>& sweep_;
  SweepStatistics& statistics_;
  Vec3 e_;
  Clearance best_{0, 0};  ///< pose 0, so that a depth of 0 is no improvement
};

}  // namespace clearway
