#pragma once

#include <cmath>
#include <cstdint>

#include "core/sweep/sweep_ref.hpp"

namespace clearway {

/// Finds how deep one environment point lies inside solids at single poses.
template <typename Element>
class DepthAtPose {
 public:
  /// sweep and statistics must outlive this object.
  CLEARWAY_HD DepthAtPose(const SweepRefOf<Element>& sweep, const Vec3& e,
                          SweepStatistics& statistics)
      : sweep_(sweep), statistics_(statistics), e_(e) {}

  /// The square of the depth: the greatest, over the solids that contain e, of the least d2 to
  /// their triangles; 0 if no solid contains e. A result less than `below` is not exact, but at
  /// least the true square. near: any triangle to begin with; becomes the nearest one.
  CLEARWAY_HD double squared(std::uint32_t pose_index, double below, std::uint32_t& near) const {
    const Pose& pose = sweep_.motion.poses[pose_index];
    const SolidPartsRef& solids = sweep_.field.inside.solids;
    const Vec3 x = pulled_back(pose, e_);
    double deepest = 0;
    const auto keep = [&](double squared, std::uint32_t triangle) {
      if (squared >= deepest) near = triangle;
      deepest = greater_of(deepest, squared);
    };
    const std::uint32_t first_near = near;
    solids.any_with(
        x,
        [&](std::uint32_t solid) {
          if (!(below > 0) || !is_of(solids.parts[solid], first_near)) return false;
          const double squared = squared_at(pose, solids.triangles[first_near]);
          if (!(squared < below)) return false;
          keep(squared, first_near);
          return true;
        },
        [&](std::uint32_t solid) {
          ++statistics_.exact_tests;
          const std::uint32_t first = solids.parts[solid].first;
          const bool has_guess = is_of(solids.parts[solid], first_near);
          const SolidPartsRef::Tree tree = solids.tree(solid);
          const std::uint32_t nearest = tree.nearest(x, has_guess ? first_near - first : 0).element;
          keep(least_squared(tree, nearest, pose_index, x, below), first + nearest);
          return false;
        });
    return deepest;
  }

 private:
  CLEARWAY_HD static bool is_of(const SolidPart& part, std::uint32_t triangle) {
    return triangle >= part.first && triangle - part.first < part.count;
  }

  CLEARWAY_HD double squared_at(const Pose& pose, const Triangle& t) const {
    return squared_distance(e_, transform(pose, t));
  }

  /// The least d2 to the triangles of a solid, or any d2 that is below `below`.
  CLEARWAY_HD double least_squared(const SolidPartsRef::Tree& tree, std::uint32_t nearest,
                                   std::uint32_t pose_index, const Vec3& x, double below) const {
    const Pose& pose = sweep_.motion.poses[pose_index];
    double least = squared_at(pose, tree.elements[nearest]);
    double ball = squared_ball(least, pose_index);
    if (least < below) return least;
    tree.any(
        [&](const Box& box) {
          return least_squared_distance(box, x) > ball ? ModelStep::kSkip : ModelStep::kEnter;
        },
        [&](const Triangle& t) {
          if (squared_distance(x, t) > ball) return false;
          const double squared = squared_at(pose, t);
          if (!(squared < least)) return false;
          least = squared;
          ball = squared_ball(least, pose_index);
          return least < below;
        });
    return least;
  }

  /// Square of a distance from x: triangles beyond it have only larger d2 at the pose.
  CLEARWAY_HD double squared_ball(double least, std::uint32_t pose_index) const {
    const double reach = (std::sqrt(least) * kRoundedUp + sweep_.rounding) /
                         sweep_.motion.inverse_poses[pose_index].least * kRoundedUp;
    return reach * reach * kRoundedUp;
  }

  const SweepRefOf<Element>& sweep_;
  SweepStatistics& statistics_;
  Vec3 e_;
};

/// The square of a depth that stays below the depth with square `best` when `more` metres are
/// added, roundings included; 0 if there is none.
CLEARWAY_HD inline double squared_depth_below(double best, double more) {
  const double depth = std::sqrt(best) * (1 - 256 * kUnitRoundoff) - more;
  return depth > 0 ? depth * depth : 0;
}

/// Finds the greatest depth of one environment point by branch and bound over the motion tree.
/// Whatever is given up is proven to have only computed depths below the best so far, so that ties
/// reach the lowest pose (docs/design/numerics.md, "Solids").
template <typename Element>
class SolidDepth {
 public:
  /// best: the best known so far; used only if it is inside.
  CLEARWAY_HD SolidDepth(const SweepRefOf<Element>& sweep, const Vec3& e, const Clearance& best,
                         SweepStatistics& statistics)
      : sweep_(sweep), statistics_(statistics), e_(e), at_pose_(sweep, e_, statistics) {
    if (best.squared < 0) best_ = best;
  }
  SolidDepth(const SolidDepth&) = delete;
  SolidDepth& operator=(const SolidDepth&) = delete;

  /// The greatest depth so far: `squared` is below 0 if the point was inside at any pose, otherwise
  /// 0.
  CLEARWAY_HD const Clearance& best() const { return best_; }

  /// Searches every pose of a node of the motion tree.
  CLEARWAY_HD void search(std::uint32_t top) {
    if (is_outside(top)) return;
    find_deep(top);
    const std::uint32_t end = top + size_of(top);
    for (std::uint32_t at = top; at < end;) at += is_done(at) ? size_of(at) : 1;
  }

  /// Searches one pose.
  CLEARWAY_HD void offer(std::uint32_t pose) { offer(pose, -best_.squared); }

 private:
  CLEARWAY_HD std::uint32_t size_of(std::uint32_t at) const {
    return 2 * sweep_.motion.nodes[at].count - 1;
  }

  /// Searches one pose and returns the square of the depth or an upper bound on it. below: as for
  /// DepthAtPose::squared(), at most the square of the best.
  CLEARWAY_HD double offer(std::uint32_t pose, double below) {
    const double squared = at_pose_.squared(pose, below, near_);
    if ((squared > -best_.squared || (squared == -best_.squared && pose < best_.pose)) &&
        sweep_.counts(e_, pose)) {
      best_ = {0 - squared, pose};
    }
    return squared;
  }

  /// Descends to one pose, each time into the half whose middle pose is deeper. Most other poses
  /// then need no exact depth.
  CLEARWAY_HD void find_deep(std::uint32_t top) {
    const MotionNode* nodes = sweep_.motion.nodes;
    for (std::uint32_t at = top; nodes[at].count > 2;) {
      const std::uint32_t later = nodes[at].later;
      const double before = offer(nodes[at + 1].mid, -best_.squared);
      at = offer(nodes[later].mid, -best_.squared) > before ? later : at + 1;
    }
  }

  /// Whether it is proven that the point is inside, or above the floor, at no pose of a node.
  CLEARWAY_HD bool is_outside(std::uint32_t at) {
    ++statistics_.point_tests;
    const MotionNode& node = sweep_.motion.nodes[at];
    if (sweep_.floor_side(node, e_) == FloorSide::kBelow) return true;
    const InversePose& back = sweep_.motion.inverse_poses[node.mid];
    const Vec3 x = back.apply(e_);
    const double squared_lower = sweep_.field.bounds(x).squared_lower;
    const bool is_same = farther(back.least, squared_lower, node.delta + sweep_.rounding);
    return is_same && !sweep_.is_inside(x, squared_lower);
  }

  /// Whether the poses below a node need no look: at none of them is the depth greater than at the
  /// middle pose by more than delta.
  CLEARWAY_HD bool is_done(std::uint32_t at) {
    if (is_outside(at)) return true;
    const MotionNode& node = sweep_.motion.nodes[at];
    const double more = node.count == 1 ? 0 : node.delta + 2 * sweep_.rounding;
    const double below =
        node.count == 1 ? -best_.squared : squared_depth_below(-best_.squared, more);
    const double squared = offer(node.mid, below);
    if (node.count == 1) return true;
    const double most = (std::sqrt(squared) + more) * kRoundedUp;
    return most * most * kRoundedUp < -best_.squared;
  }

  const SweepRefOf<Element>& sweep_;
  SweepStatistics& statistics_;
  Vec3 e_;
  DepthAtPose<Element> at_pose_;
  std::uint32_t near_ = 0;  ///< triangle of the solids that was near e at the last pose
  Clearance best_{0, 0};    ///< pose 0, so that a depth of 0 is not an improvement
};

}  // namespace clearway
