#pragma once

#include <cmath>
#include <cstdint>

#include "core/query/clearance_set.hpp"
#include "core/sweep/sweep_ref.hpp"
#include "core/util/bit_reversal_order.hpp"

namespace clearway {

/// The chord that a point moves along, seen from the model, while the model moves through the poses
/// of a node.
struct PointChord {
  Vec3 first, way;
  double per_squared = 0;  ///< of the way's length, 0 where it is none

  CLEARWAY_HD PointChord(const MotionTreeRef& motion, const MotionNode& node, const Vec3& e)
      : first(motion.inverse_poses[node.first].apply(e)), way{} {
    if (node.count == 1) return;
    const Vec3 last = motion.inverse_poses[node.first + node.count - 1].apply(e);
    way = {last.x - first.x, last.y - first.y, last.z - first.z};
    const double squared = squared_length(way.x, way.y, way.z);
    if (squared > 1e-300) per_squared = 1 / squared;
  }

  CLEARWAY_HD Box box() const {
    Box box{first, first};
    for (int k = 0; k < 3; ++k) (way[k] < 0 ? box.lo : box.hi)[k] += way[k];
    return box;
  }

  /// Of the place nearest to m, from 0 to 1.
  CLEARWAY_HD double place(const Vec3& m) const {
    const double along =
        (way.x * (m.x - first.x) + way.y * (m.y - first.y) + way.z * (m.z - first.z)) * per_squared;
    return along > 0 ? (along < 1 ? along : 1) : 0;
  }

  CLEARWAY_HD double squared_distance_to(const Vec3& m) const {
    const double t = place(m);
    return squared_length(m.x - first.x - t * way.x, m.y - first.y - t * way.y,
                          m.z - first.z - t * way.z);
  }
};

/// The exact clearance of one environment point: branch and bound over motion tree and model. What
/// is given up is proven to have only computed d2 above the best so far, so that ties reach the
/// lowest pose (docs/design/numerics.md, "Clearance").
class PointClearance {
 public:
  /// best: known so far, of the point or the limit that clearances are below.
  CLEARWAY_HD PointClearance(const SweepRef& sweep, const Vec3& e, const Clearance& best,
                             SweepStatistics& statistics)
      : sweep_(sweep), statistics_(statistics), e_(e) {
    set_best(best.squared, best.pose);
  }

  CLEARWAY_HD const Clearance& best() const { return best_; }
  /// That the best was found with.
  CLEARWAY_HD const Vec3& model_point() const { return near_; }

  CLEARWAY_HD void offer(std::uint32_t pose, const Vec3& m) {
    const double squared = squared_distance(e_, transform(sweep_.motion.poses[pose], m));
    if (!(squared < best_.squared || (squared == best_.squared && pose < best_.pose))) return;
    near_ = m;
    set_best(squared, pose);
  }

  /// Every pose of some nodes, at most kMostNodes. First a look at all, far apart ones first, for a
  /// best that is close from the start; then the one that may be nearest comes first.
  CLEARWAY_HD void search(const std::uint32_t* nodes, std::uint32_t count) {
    double squared_lower[kMostNodes];
    BitReversalOrder(count).for_each([&](std::uint32_t i) {
      squared_lower[i] = look(nodes[i]);
      return true;
    });
    std::uint32_t nearest = 0;
    for (std::uint32_t i = 1; i < count; ++i) {
      if (squared_lower[i] < squared_lower[nearest]) nearest = i;
    }
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t next = i == 0 ? nearest : i == nearest ? 0 : i;
      search(nodes[next], squared_lower[next]);
    }
  }

  static constexpr std::uint32_t kMostNodes = BitReversalOrder::kMost;

 private:
  CLEARWAY_HD std::uint32_t size_of(std::uint32_t at) const {
    return 2 * sweep_.motion.nodes[at].count - 1;
  }

  /// What the square of the distance is at least, pulled back by the middle pose of the node.
  CLEARWAY_HD double look(std::uint32_t at) {
    ++statistics_.point_tests;
    const MotionNode& node = sweep_.motion.nodes[at];
    const InversePose& back = sweep_.motion.inverse_poses[node.mid];
    const ModelFieldRef::Bounds bounds = sweep_.field.bounds(back.apply(e_));
    if (bounds.near != ModelFieldRef::kNone && !farther(back.least, bounds.squared_lower, reach_)) {
      offer(node.mid, sweep_.model.points[bounds.near]);
    }
    return bounds.squared_lower;
  }

  CLEARWAY_HD bool is_given_up(std::uint32_t at, double squared_lower) const {
    const MotionNode& node = sweep_.motion.nodes[at];
    return farther(sweep_.motion.inverse_poses[node.mid].least, squared_lower, reach_ + node.delta);
  }

  /// In preorder the subtree of a range of n poses is a run of 2 n - 1 nodes, so that no stack is
  /// needed.
  CLEARWAY_HD void search(std::uint32_t top, double squared_lower) {
    const std::uint32_t end = top + size_of(top);
    for (std::uint32_t at = top; at < end;) {
      if (at != top) squared_lower = look(at);
      if (is_given_up(at, squared_lower)) {
        at += size_of(at);
      } else if (is_straight(sweep_.motion.chords[at])) {
        search_model(at);
        at += size_of(at);
      } else {
        ++at;
      }
    }
  }

  /// Whether what its chord is wrong leaves few model points open.
  CLEARWAY_HD bool is_straight(const MotionChord& chord) const {
    return chord.is_one_place() || static_cast<double>(chord.error) * reach_ <= sweep_.open_area;
  }

  /// The square of how far from its chord a model point can lie that is the nearest at a pose of
  /// the node.
  CLEARWAY_HD double squared_ball(const MotionChord& chord) const {
    const double error = chord.is_one_place() ? 0 : static_cast<double>(chord.error);
    const double ball =
        ((reach_ + 2 * sweep_.rounding) / static_cast<double>(chord.least) + error) * kRoundedUp;
    return ball * ball * kRoundedUp;
  }

  /// One search of the model for all poses of a straight node.
  CLEARWAY_HD void search_model(std::uint32_t at) {
    ++statistics_.exact_tests;
    const MotionChord& straight = sweep_.motion.chords[at];
    const PointChord chord(sweep_.motion, sweep_.motion.nodes[at], e_);
    double squared = squared_ball(straight);
    sweep_.model.visit_nearest_first(
        chord.box(), [&] { return squared; },
        [&](const Vec3& m) { return chord.squared_distance_to(m); },
        [&](const Vec3& m) {
          search_poses(at, m, chord);
          squared = squared_ball(straight);
        });
  }

  /// One model point against the poses of a straight node.
  CLEARWAY_HD void search_poses(std::uint32_t top, const Vec3& m, const PointChord& chord) {
    const MotionTreeRef& motion = sweep_.motion;
    const MotionNode& node = motion.nodes[top];
    if (node.count == 1 || motion.chords[top].is_one_place()) return offer(node.first, m);
    const double guess = chord.place(m) * (node.count - 1) + 0.5;
    offer(node.first + static_cast<std::uint32_t>(guess), m);
    const std::uint32_t end = top + size_of(top);
    for (std::uint32_t at = top + 1; at < end;) {
      const MotionNode& part = motion.nodes[at];
      if (part.count == 1 || motion.chords[at].is_one_place()) {
        offer(part.first, m);
        at += size_of(at);
      } else if (PointChord(motion, part, e_).squared_distance_to(m) >
                 squared_ball(motion.chords[at])) {
        at += size_of(at);
      } else {
        ++at;
      }
    }
  }

  CLEARWAY_HD void set_best(double squared, std::uint32_t pose) {
    best_ = {squared, pose};
    reach_ = std::sqrt(squared) * kRoundedUp + sweep_.rounding;
  }

  const SweepRef& sweep_;
  SweepStatistics& statistics_;
  Vec3 e_;
  Clearance best_{};
  double reach_ = 0;  ///< a pose at which no model point is nearer than this has only larger d2
  Vec3 near_{};
};

}  // namespace clearway
