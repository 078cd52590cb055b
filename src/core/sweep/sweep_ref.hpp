#pragma once

#include <cmath>
#include <cstdint>

#include "core/geometry/floor.hpp"
#include "core/geometry/model_element.hpp"
#include "core/geometry/model_tree_ref.hpp"
#include "core/geometry/sweep_bounds.hpp"
#include "core/geometry/wide_tree_ref.hpp"
#include "core/sweep/field/model_field_ref.hpp"
#include "core/sweep/swept_step.hpp"
#include "core/trajectory/motion_tree_ref.hpp"

namespace clearway {

/// Counts of the steps that a descent took.
struct SweepStatistics {
  std::uint64_t node_tests = 0;     ///< field look-ups for cells, runs of blocks and blocks
  std::uint64_t point_tests = 0;    ///< field look-ups for points
  std::uint64_t exact_tests = 0;    ///< ball searches in the model
  std::uint64_t points_tested = 0;  ///< points that no block dismissed

  CLEARWAY_HD void add(const SweepStatistics& other) {
    node_tests += other.node_tests;
    point_tests += other.point_tests;
    exact_tests += other.exact_tests;
    points_tested += other.points_tested;
  }

  /// The counts added since an earlier state.
  CLEARWAY_HD SweepStatistics since(const SweepStatistics& earlier) const {
    return {node_tests - earlier.node_tests, point_tests - earlier.point_tests,
            exact_tests - earlier.exact_tests, points_tested - earlier.points_tested};
  }
};

/// Poses around one of them: those of a motion node, or a single one.
struct PosesAround {
  std::uint32_t pose;
  double delta = 0;  ///< no model point is farther than this from where it is at `pose`, metres
  MotionFloor floor = {};
};

/// Where points lie at some poses, seen from the floor.
enum class FloorSide {
  kBelow,  ///< no pair of the points and the poses counts
  kOpen,   ///< pairs have to be looked at one by one
  kAbove,  ///< every pair counts
};

/// A set of environment points, known only by its box.
struct PointBox {
  Box box;
  Vec3 centre;
  double rho;  ///< no point is farther than this from the centre

  CLEARWAY_HD explicit PointBox(const Box& of)
      : box(of), centre(of.centre()), rho(half_diagonal(of)) {}

  /// No point is farther than this from the centre along each axis.
  CLEARWAY_HD Vec3 half() const {
    Vec3 out;
    for (int k = 0; k < 3; ++k) {
      out[k] = greater_of(box.hi[k] - centre[k], centre[k] - box.lo[k]) * kRoundedUp;
    }
    return out;
  }
};

/// What becomes of a motion node for the points of a box.
enum class SweepBoxClass {
  kDismissed,  ///< no pose of the node matters
  kAccepted,   ///< the model at the middle pose touches, or contains, every point of the box
  kSplit,      ///< the node has to be looked at in halves
  kKept,       ///< the node is fine enough for a box of this size
};

/// What becomes of a motion node for a single point.
enum class SweepVerdict {
  kDismissed,  ///< no pose of the node touches the point, or none has to be found
  kHitAtMid,   ///< the model touches the point at the middle pose
  kOpen,       ///< to be looked at in halves; for a single pose collides_at() decides
};

/// The tests of the sweep on data on the host or on a device: the inverse query at one node of the
/// motion tree. e collides with pose i exactly if the model is closer than the radius to e pulled
/// back by pose i. Bounds: docs/design/numerics.md ("Sweep"). Element: what the model consists of.
template <typename Element>
struct SweepRefOf {
  /// A node of the motion tree is split for a box while it moves more than this many times the
  /// box's half diagonal.
  static constexpr double kMotionPerBox = 1.0;

  MotionTreeRef motion;
  ModelTreeRefOf<StoredElement<Element>> model;
  ModelFieldRef field;
  /// Wide tree of the model's elements; set only with a clearance and, for points, with a profile
  WideTreeRefOf<StoredElement<Element>> wide;
  double radius;     ///< points strictly closer than this are hits, metres
  double clearance;  ///< metres; 0: not asked for
  double profile;    ///< metres; 0: not asked for
  double open_area;  ///< square metres: bound on a chord's error times the distance
  double rounding;   ///< rounding of a test of one point at one pose, metres
  bool first_pose;
  bool between_poses;
  double floor = kNoFloor;
  double floor_rounding = 0;  ///< bound on the error of a height that is not the exact test's

  CLEARWAY_HD bool has_floor() const { return motion.floors != nullptr; }

  CLEARWAY_HD PosesAround around(const MotionNode& node) const {
    return {node.mid, node.delta,
            has_floor() ? motion.floors[&node - motion.nodes] : MotionFloor{}};
  }

  /// Where all points that are at most `half` from a centre along each axis lie at the poses.
  CLEARWAY_HD FloorSide floor_side(const PosesAround& poses, const Vec3& centre,
                                   const Vec3& half) const {
    if (!has_floor()) return FloorSide::kAbove;
    const InversePose& back = motion.inverse_poses[poses.pose];
    double height = 0, spread = floor_rounding + poses.floor.rise, squared = 0;
    for (int k = 0; k < 3; ++k) {
      const double away = centre[k] - back.translation[k];
      height += back.inverse[6 + k] * away;
      spread += std::fabs(back.inverse[6 + k]) * half[k];
      const double farthest = std::fabs(away) + half[k];
      squared += farthest * farthest;
    }
    spread = (spread + poses.floor.tilt * std::sqrt(squared)) * kRoundedUp;
    if (height + spread < floor) return FloorSide::kBelow;
    return height - spread >= floor ? FloorSide::kAbove : FloorSide::kOpen;
  }

  CLEARWAY_HD FloorSide floor_side(const MotionNode& node, const Vec3& e) const {
    if (!has_floor()) return FloorSide::kAbove;
    return floor_side(around(node), e, Vec3{0, 0, 0});
  }

  /// Whether all points within rho of the centre surely count at a pose.
  CLEARWAY_HD bool is_above(std::uint32_t pose, const Vec3& centre, double rho) const {
    return floor_side({pose}, centre, {rho, rho, rho}) == FloorSide::kAbove;
  }

  /// Whether the pair of e and a pose counts.
  CLEARWAY_HD bool counts(const Vec3& e, std::uint32_t pose) const {
    const FloorSide side = floor_side({pose}, e, {0, 0, 0});
    if (side != FloorSide::kOpen) return side == FloorSide::kAbove;
    return is_above_floor(motion.poses[pose], e, floor);
  }

  /// Whether the pair of e and the single pose of a node counts; between poses, the way from it.
  CLEARWAY_HD bool counts_at(const Vec3& e, const MotionNode& node) const {
    return counts(e, node.mid) || (moves_on(node) && counts(e, node.mid + 1));
  }

  /// Whether the least d2 below the clearance decides by itself which points collide.
  CLEARWAY_HD bool hits_follow_from_clearance() const { return clearance >= radius && !first_pose; }

  CLEARWAY_HD bool moves_on(const MotionNode& node) const {
    if constexpr (kIsTriangle<Element>) return false;
    return between_poses && node.count == 1 && node.first + 1 < motion.pose_count;
  }

  /// Upper bound on the first pose if a model point hits at `pose`. Between poses that is also the
  /// end of the way from the pose before, which then counts.
  CLEARWAY_HD std::uint32_t first_pose_of_hit(std::uint32_t pose) const {
    return between_poses && pose > 0 ? pose - 1 : pose;
  }

  /// Whether a box may be accepted as a whole: every point that collides is marked alike, and
  /// nothing else is asked about it.
  CLEARWAY_HD bool accepts_boxes() const { return !first_pose && !(clearance > 0); }

  /// Greatest distance from a curve, wrong by at most `error`, at which an element of the model can
  /// lie that is within `reach` at one of its poses. The poses shrink no distance by more than the
  /// factor `least`.
  CLEARWAY_HD double ball_around_curve(double reach, double least, double error) const {
    return ((reach + 2 * rounding) / least + error) * kRoundedUp;
  }

  using BoxClass = SweepBoxClass;

  /// What becomes of a node for the points of a box. limit: distance beyond which nothing matters
  /// to them. accept: whether kAccepted is of use.
  CLEARWAY_HD BoxClass classify_box(const MotionNode& node, const PointBox& points, double limit,
                                    bool accept) const {
    const Vec3& centre = points.centre;
    const double rho = points.rho;
    if (has_floor()) {
      const Vec3 half = points.half();
      const FloorSide side = floor_side(around(node), centre, half);
      if (side == FloorSide::kBelow) return BoxClass::kDismissed;
      accept = accept && (side == FloorSide::kAbove ||
                          floor_side({node.mid}, centre, half) == FloorSide::kAbove);
    }
    const InversePose& back = motion.inverse_poses[node.mid];
    const double reach = limit + node.delta + rho + rounding;
    const ModelFieldRef::Bounds bounds = field.bounds(back.apply(centre));
    if (farther(back.least, bounds.squared_lower, reach)) {
      if (!is_inside(back.apply(centre), bounds.squared_lower)) return BoxClass::kDismissed;
      if (accept) return BoxClass::kAccepted;
      return node.count > 1 && node.delta > kMotionPerBox * rho ? BoxClass::kSplit
                                                                : BoxClass::kKept;
    }
    if (accept && rho < radius && bounds.near != ModelFieldRef::kNone &&
        collides_with_all(points.box,
                          transform(motion.poses[node.mid], model.elements[bounds.near]), radius,
                          rounding)) {
      return BoxClass::kAccepted;
    }
    const bool fine = node.delta <= kMotionPerBox * rho;
    if (node.count > 1) return fine ? BoxClass::kKept : BoxClass::kSplit;
    if constexpr (!kIsTriangle<Element>) {
      const bool long_step = moves_on(node) && !fine;
      if (long_step &&
          !SweptStep(motion, model, node.first, radius, rounding).may_touch(centre, rho)) {
        return BoxClass::kDismissed;
      }
    }
    return BoxClass::kKept;
  }

  /// A distance beyond which nothing matters to any point within rho of `centre`: the clearance
  /// asked for, or a smaller bound from a pair of points at the middle pose of one of `nodes`;
  /// never less than a radius still to be searched.
  CLEARWAY_HD double clearance_limit(const Vec3& centre, double rho, const std::uint32_t* nodes,
                                     std::uint32_t count, SweepStatistics& statistics) const {
    double squared = kInfinity;
    for (std::uint32_t i = 0; i < count; ++i) {
      ++statistics.node_tests;
      const std::uint32_t mid = motion.nodes[nodes[i]].mid;
      const std::uint32_t near = field.bounds(motion.inverse_poses[mid].apply(centre)).near;
      if (near == ModelFieldRef::kNone || !is_above(mid, centre, rho)) continue;
      const double here =
          squared_distance(centre, transform(motion.poses[mid], model.elements[near]));
      if (here < squared) squared = here;
    }
    const double upper = std::sqrt(squared) * kRoundedUp + rho + rounding;
    const double widest = clearance * kRoundedUp;
    const double limit = upper < widest ? upper : widest;
    return hits_follow_from_clearance() ? limit : greater_of(limit, radius);
  }

  /// Whether a solid contains x, if a bound proves that no surface is within the rounding. The
  /// answer is then the same for all places and poses for which that proof holds.
  CLEARWAY_HD bool is_inside(const Vec3& x, double squared_lower) const {
    if constexpr (kIsSolid<Element>) return field.contains(x, squared_lower);
    return false;
  }

  using Verdict = SweepVerdict;

  /// Which pairs of e and the poses of a node may count: none (kBelow), at least the one with the
  /// middle pose (kAbove), or others but not that one (kOpen).
  CLEARWAY_HD FloorSide counting(const MotionNode& node, const Vec3& e) const {
    const FloorSide side = floor_side(node, e);
    if (side != FloorSide::kOpen) return side;
    if (counts(e, node.mid)) return FloorSide::kAbove;
    return node.count == 1 && !moves_on(node) ? FloorSide::kBelow : FloorSide::kOpen;
  }

  /// Looks at a node for the point e without a search of the model. squared_lower: becomes the
  /// field's bound at the middle pose.
  CLEARWAY_HD Verdict look(const Vec3& e, const MotionNode& node, SweepStatistics& statistics,
                           double& squared_lower) const {
    ++statistics.point_tests;
    squared_lower = kInfinity;
    const FloorSide side = counting(node, e);
    if (side == FloorSide::kBelow) return Verdict::kDismissed;
    const Vec3 x = motion.inverse_poses[node.mid].apply(e);
    const ModelFieldRef::Bounds bounds = field.bounds(x);
    squared_lower = bounds.squared_lower;
    return judge(e, node, side, x, squared_lower, [&] { return bounds.near; });
  }

  /// The distance from the model at the middle pose beyond which nothing collides at any of a
  /// node's poses.
  CLEARWAY_HD double reach_of(const MotionNode& node) const {
    return radius + node.delta + rounding;
  }

  /// What look() says of a node at which some pair counts. side: from counting(); x: e pulled back
  /// by the middle pose; squared_lower, near(): the field's bounds there.
  template <typename Near>
  CLEARWAY_HD Verdict judge(const Vec3& e, const MotionNode& node, FloorSide side, const Vec3& x,
                            double squared_lower, Near near) const {
    const bool counts_at_mid = side == FloorSide::kAbove;
    const InversePose& back = motion.inverse_poses[node.mid];
    if (farther(back.least, squared_lower, reach_of(node))) {
      if (!is_inside(x, squared_lower)) return Verdict::kDismissed;
      return counts_at_mid ? Verdict::kHitAtMid : Verdict::kOpen;
    }
    if (counts_at_mid && may_hit_at_mid(back, squared_lower)) {
      const std::uint32_t element = near();
      if (element != ModelFieldRef::kNone &&
          collides(e, transform(motion.poses[node.mid], model.elements[element]), radius)) {
        return Verdict::kHitAtMid;
      }
    }
    return Verdict::kOpen;
  }

  /// Whether to ask the predicate. For points always, because it costs no more than the test.
  CLEARWAY_HD bool may_hit_at_mid(const InversePose& back, double squared_lower) const {
    if constexpr (!kIsTriangle<Element>) return true;
    return !farther(back.least, squared_lower, radius + rounding);
  }

  CLEARWAY_HD Verdict look(const Vec3& e, const MotionNode& node,
                           SweepStatistics& statistics) const {
    double squared_lower;
    return look(e, node, statistics, squared_lower);
  }

  /// Whether e collides at a single pose that look() left open, or on the way from it to the next.
  CLEARWAY_HD bool collides_at(const Vec3& e, const MotionNode& node) const {
    if (!counts_at(e, node)) return false;
    if constexpr (!kIsTriangle<Element>) {
      if (moves_on(node)) {
        return SweptStep(motion, model, node.first, radius, rounding).touches(e);
      }
    }
    const InversePose& back = motion.inverse_poses[node.mid];
    const Pose& pose = motion.poses[node.mid];
    if constexpr (kIsSolid<Element>) {
      if (field.inside.solids.contains(pulled_back(pose, e))) return true;
    }
    const double ball = (radius + rounding) / back.least * kRoundedUp;
    return model.any_within(back.apply(e), ball * ball * kRoundedUp, [&](const Element& m) {
      return collides(e, transform(pose, m), radius);
    });
  }
};

using SweepRef = SweepRefOf<Vec3>;

}  // namespace clearway
