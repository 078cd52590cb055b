#pragma once

#include <cmath>
#include <cstdint>

#include "core/query/search_result.hpp"
#include "core/sweep/point_curve.hpp"
#include "core/sweep/solid_depth.hpp"
#include "core/sweep/sweep_ref.hpp"
#include "core/sweep/triangle_curve.hpp"
#include "core/util/bit_reversal_order.hpp"

namespace clearway {

/// Finds the exact clearance of one environment point by branch and bound over motion tree and
/// model. Whatever is given up is proven to have only computed d2 above the best so far, so that
/// ties reach the lowest pose (docs/design/numerics.md, "Clearance"). For solids the depth is
/// searched first; if its value is below 0, it is the answer.
template <typename Element>
class PointClearance {
 public:
  /// best: the best known so far for this point, or the limit that clearances must be below.
  CLEARWAY_HD PointClearance(const SweepRefOf<Element>& sweep, const Vec3& e, const Clearance& best,
                             SweepStatistics& statistics)
      : sweep_(sweep), statistics_(statistics), e_(e) {
    best_ = best;
    if (!is_inside()) set_best(best.squared, best.pose);
  }

  CLEARWAY_HD const Clearance& best() const { return best_; }
  CLEARWAY_HD bool is_inside() const { return best_.squared < 0; }
  /// The model's element that the best was found with; has no meaning if the point is inside.
  CLEARWAY_HD const Element& element() const { return near_; }

  /// Tests whether the point is inside at a pose, and keeps its depth if that is better.
  CLEARWAY_HD void offer_inside(std::uint32_t pose) {
    if constexpr (kIsSolid<Element>) {
      SolidDepth<Element> depth(sweep_, e_, best_, statistics_);
      depth.offer(pose);
      if (depth.best().squared < 0) best_ = depth.best();
    }
  }

  /// Takes the model's element at a pose for the best if it is. Returns whether it did.
  CLEARWAY_HD bool offer(std::uint32_t pose, const Element& m) {
    const double squared = squared_distance(e_, transform(sweep_.motion.poses[pose], m));
    if (!(squared < best_.squared || (squared == best_.squared && pose < best_.pose))) return false;
    if (!sweep_.counts(e_, pose)) return false;
    near_ = m;
    set_best(squared, pose);
    return true;
  }

  /// Searches every pose of some nodes, at most kMostNodes. It first looks once at each, with those
  /// far apart first, so that the best is close from the start; then it begins with the node that
  /// may be nearest.
  CLEARWAY_HD void search(const std::uint32_t* nodes, std::uint32_t count) {
    search_inside(nodes, count);
    if (is_inside()) return;
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
  /// Slack in poses that covers the rounding of a place.
  static constexpr double kPlaceSlack = 1e-6;

  CLEARWAY_HD std::uint32_t size_of(std::uint32_t at) const {
    return 2 * sweep_.motion.nodes[at].count - 1;
  }

  CLEARWAY_HD void search_inside(const std::uint32_t* nodes, std::uint32_t count) {
    if constexpr (kIsSolid<Element>) {
      SolidDepth<Element> depth(sweep_, e_, best_, statistics_);
      for (std::uint32_t i = 0; i < count; ++i) depth.search(nodes[i]);
      if (depth.best().squared < 0) best_ = depth.best();
    }
  }

  /// Lower bound on the squared distance of the point, pulled back by the middle pose of the node.
  CLEARWAY_HD double look(std::uint32_t at) {
    ++statistics_.point_tests;
    const MotionNode& node = sweep_.motion.nodes[at];
    const InversePose& back = sweep_.motion.inverse_poses[node.mid];
    const ModelFieldRef::Bounds bounds = sweep_.field.bounds(back.apply(e_));
    if (bounds.near != ModelFieldRef::kNone && !farther(back.least, bounds.squared_lower, reach_)) {
      offer(node.mid, sweep_.model.elements[bounds.near]);
    }
    return bounds.squared_lower;
  }

  /// Searches all poses of a node. In preorder the subtree of a range of n poses is a run of 2 n -
  /// 1 nodes, so that no stack is needed.
  CLEARWAY_HD void search(std::uint32_t top, double squared_lower) {
    const std::uint32_t end = top + size_of(top);
    for (std::uint32_t at = top; at < end;) {
      if (at != top) squared_lower = look(at);
      at += is_done(at, squared_lower) ? size_of(at) : 1;
    }
  }

  /// Whether the poses of a node are given up or have been searched. Where only some of them may
  /// count, its halves are searched instead: the nearest pairs may be pairs that do not count, so
  /// that none would come near enough to bound the others.
  CLEARWAY_HD bool is_done(std::uint32_t at, double squared_lower) {
    const MotionNode& node = sweep_.motion.nodes[at];
    const FloorSide side = sweep_.floor_side(node, e_);
    if (side == FloorSide::kBelow) return true;
    const double least = sweep_.motion.inverse_poses[node.mid].least;
    if (farther(least, squared_lower, reach_ + node.delta)) return true;
    if (side == FloorSide::kOpen) {
      if (!sweep_.motion.curves[at].is_one_place()) return false;
      if (!sweep_.counts(e_, node.first)) return true;
    }
    return search_model(at);
  }

  /// Whether a curve with this error leaves few model points open.
  CLEARWAY_HD bool is_close_enough(double error) const {
    return error * reach_ <= sweep_.open_area;
  }

  /// Greatest distance from a curve, wrong by at most `error`, at which a model point can lie that
  /// is the nearest at one of its poses.
  CLEARWAY_HD double ball(double least, double error) const {
    return sweep_.ball_around_curve(reach_, least, error);
  }

  /// Searches the model once for all poses of a node. Returns false if the node's curve is not
  /// close enough.
  CLEARWAY_HD bool search_model(std::uint32_t at) {
    const MotionCurve& smooth = sweep_.motion.curves[at];
    const MotionNode& node = sweep_.motion.nodes[at];
    const bool one_place = smooth.is_one_place();
    double error = one_place ? 0 : static_cast<double>(smooth.error);
    if (!one_place && !is_close_enough(error)) return false;
    const auto least = static_cast<double>(smooth.least);
    if constexpr (kIsTriangle<Element>) {
      search_triangles(node, TriangleCurve(sweep_.motion, node, e_), one_place, least, error);
    } else {
      const PointCurve curve(sweep_.motion, node, e_, ball(least, error));
      error += curve.beside();
      if (!one_place && !is_close_enough(error)) return false;
      search_points(node, curve, one_place, least, error);
    }
    return true;
  }

  CLEARWAY_HD void search_points(const MotionNode& node, const PointCurve& curve, bool one_place,
                                 double least, double error) {
    ++statistics_.exact_tests;
    double squared = squared_ball(least, error);
    sweep_.wide.any_nearest_first(
        curve.box(), [&] { return squared; },
        [&](const PointPacket& packet, double(&out)[PointPacket::kMost]) {
          curve.to_points(packet, out);
        },
        [&](const PointPacket& packet, std::uint32_t i) {
          const Vec3 m = packet.point(i);
          if (one_place) {
            offer(node.first, m);
          } else {
            search_poses(node, m, curve, least, error);
          }
          squared = squared_ball(least, error);
          return false;
        });
  }

  CLEARWAY_HD void search_triangles(const MotionNode& node, const TriangleCurve& curve,
                                    bool one_place, double least, double error) {
    ++statistics_.exact_tests;
    double squared = squared_ball(least, error);
    sweep_.wide.any_nearest_first(
        curve.hull(), [&] { return squared; },
        [&](const FloatPacket& packet, float(&out)[FloatPacket::kMost]) {
          curve.to_triangles(packet, out);
        },
        [&](const FloatPacket& packet, std::uint32_t i) {
          const StoredElement<Element>& t = sweep_.model.elements[packet.index[i]];
          const auto try_pose = [&](std::uint32_t k) {
            if (offer(node.first + k, t)) squared = squared_ball(least, error);
            return false;
          };
          if (one_place) return try_pose(0);
          return curve.any_place(
              packet, i, node.count, [&] { return squared; }, try_pose);
        });
  }

  CLEARWAY_HD double squared_ball(double least, double error) const {
    const double radius = ball(least, error);
    return radius * radius * kRoundedUp;
  }

  /// Tests one model point against the poses of a smooth node, the likely nearest first.
  CLEARWAY_HD void search_poses(const MotionNode& node, const Vec3& m, const PointCurve& curve,
                                double least, double error) {
    const double last = node.count - 1;
    PointCurve::Places places = curve.places(m, squared_ball(least, error));
    if (places.low > places.high) return;
    const double guess = places.nearest * last + 0.5;
    const auto nearest = static_cast<std::uint32_t>(guess);
    if (offer(node.first + nearest, m)) places = curve.places(m, squared_ball(least, error));
    const double low = places.low * last - kPlaceSlack, high = places.high * last + kPlaceSlack;
    if (low > last || high < 0) return;
    const std::uint32_t begin = low > 0 ? static_cast<std::uint32_t>(std::ceil(low)) : 0;
    const std::uint32_t end = high < last ? static_cast<std::uint32_t>(high) + 1 : node.count;
    for (std::uint32_t i = begin; i < end; ++i) {
      if (i != nearest) offer(node.first + i, m);
    }
  }

  CLEARWAY_HD void set_best(double squared, std::uint32_t pose) {
    best_ = {squared, pose};
    reach_ = std::sqrt(squared) * kRoundedUp + sweep_.rounding;
  }

  const SweepRefOf<Element>& sweep_;
  SweepStatistics& statistics_;
  Vec3 e_;
  Clearance best_{};
  double reach_ = 0;  ///< a pose at which no model point is nearer than this has only larger d2
  Element near_{};
};

}  // namespace clearway
