#pragma once

#include <cstdint>

#include "core/geometry/box.hpp"
#include "core/geometry/sweep_bounds.hpp"
#include "core/geometry/wide_tree_ref.hpp"
#include "core/trajectory/motion_tree_ref.hpp"
#include "core/util/device_bits.hpp"
#include "core/util/lanes.hpp"
#include "core/util/macros.hpp"

namespace clearway {

/// The parabola c(t) = start + t way + t (1 - t) bend on which an environment point moves as seen
/// from the model while the model moves through the poses of a node; for tests against triangles.
/// It lies in the convex hull of c(0), c(1) and the point where its tangents at these two meet.
class TriangleCurve {
 public:
  CLEARWAY_HD TriangleCurve(const MotionTreeRef& motion, const MotionNode& node, const Vec3& e)
      : way_{}, bend_{} {
    const MotionParabola through(node);
    start_ = motion.inverse_poses[through.middle].apply(e);
    if (node.count == 1) return;
    const Vec3 middle = start_;
    if (through.middle != through.first) start_ = motion.inverse_poses[through.first].apply(e);
    way_ = difference(motion.inverse_poses[through.last].apply(e), start_);
    bend_ = through.bend(start_, way_, middle);
    const double squared_way = squared_length(way_.x, way_.y, way_.z);
    if (squared_way > kLeastSquaredWay) per_squared_way_ = static_cast<float>(1 / squared_way);
  }

  /// The convex hull of the curve, and its box.
  CLEARWAY_HD PlaceHull hull() const {
    return {MotionParabola::box(start_, way_, bend_),
            {start_, beyond(start_, 1, way_), beyond(beyond(start_, 0.5, way_), 0.5, bend_)}};
  }

  /// Lower bounds on the squared distances from the curve to the triangles of a packet.
  CLEARWAY_HD void to_triangles(const FloatPacket& packet,
                                float (&squared)[FloatPacket::kMost]) const {
#ifdef __CUDA_ARCH__
    to_all_triangles(packet, squared);
#else
    to_triangles_in_vectors(packet, squared);
#endif
  }

  static constexpr std::uint32_t kMostPlaces = 16;  ///< number of places that are computed together

  /// Lower bounds on the squared distances from triangle i to the parts of the curve: part k has
  /// `length` places, the first of which is at t = k length per_last.
  CLEARWAY_HD void from_parts(const FloatPacket& packet, std::uint32_t i, std::uint32_t length,
                              float per_last, float (&squared)[kMostPlaces]) const {
#ifdef __CUDA_ARCH__
    from_all_parts(packet, i, length, per_last, squared);
#else
    from_parts_in_vectors(packet, i, length, per_last, squared);
#endif
  }

  /// Lower bounds on the squares of the distances from a triangle to the places (first + k)
  /// per_last, which are close.
  CLEARWAY_HD void from_places(const FloatPacket& packet, std::uint32_t i, std::uint32_t first,
                               float per_last, float (&squared)[kMostPlaces]) const {
#ifdef __CUDA_ARCH__
    from_all_places(packet, i, first, per_last, squared);
#else
    from_places_in_vectors(packet, i, first, per_last, squared);
#endif
  }

  /// Calls visit(k) for those of `count` places that may be within the square root of within() of
  /// the triangle, until it returns true, and returns whether it did. Place k is at k / (count -
  /// 1). The part of the curve that is likely nearest comes first, and in it the nearest place.
  template <typename Within, typename Visit>
  CLEARWAY_HD bool any_place(const FloatPacket& packet, std::uint32_t i, std::uint32_t count,
                             Within within, Visit visit) const {
    constexpr std::uint32_t kMost = kMostPlaces;
    const auto per_last = static_cast<float>(1.0 / (count - 1));
    // Whole groups of places, so that no computed place goes unused.
    const std::uint32_t length = ((count - 1) / (kMost * kMost) + 1) * kMost;
    const std::uint32_t parts = (count - 1) / length + 1;
    if (parts == 1) return visit_places(packet, i, 0, count, per_last, within, visit);
    float from_part[kMost];
    from_parts(packet, i, length, per_last, from_part);
    return any_lane(from_part, parts, within, [&](std::uint32_t part) {
      const std::uint32_t begin = part * length, left = count - begin;
      const std::uint32_t end = begin + (length < left ? length : left);
      for (std::uint32_t first = begin; first < end; first += kMost) {
        const std::uint32_t used = end - first < kMost ? end - first : kMost;
        if (visit_places(packet, i, first, used, per_last, within, visit)) return true;
      }
      return false;
    });
  }

 private:
  /// A way with a smaller square is as good as a single place.
  static constexpr double kLeastSquaredWay = 1e-30;
  /// A direction with a smaller square says nothing, because its digits are lost to underflow.
  static constexpr float kLeastSquaredDirection = 1e-34F;
  /// Takes off what squares and quotients of floats round.
  static constexpr float kRoundedDown = 1 - 0x1p-20F;

  /// The curve in floats, seen from a packet's origin.
  struct Seen {
    FloatVector start, way, bend;
    float per_squared_way;
    float slack;  ///< bound on the error of distances, metres

    CLEARWAY_IN_CLONE CLEARWAY_HD FloatVector at(float t) const {
      const float rest = 1 - t;
      return {start.x + t * (way.x + rest * bend.x), start.y + t * (way.y + rest * bend.y),
              start.z + t * (way.z + rest * bend.z)};
    }
  };

  CLEARWAY_IN_CLONE CLEARWAY_HD static FloatVector in_floats(const Vec3& v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
  }

  CLEARWAY_IN_CLONE CLEARWAY_HD static float sum_of(const FloatVector& v) {
    return size_of(v.x) + size_of(v.y) + size_of(v.z);
  }

  CLEARWAY_IN_CLONE CLEARWAY_HD static float size_of(float value) {
    return value < 0 ? -value : value;
  }

  CLEARWAY_IN_CLONE CLEARWAY_HD Seen seen_from(const FloatPacket& packet) const {
    Seen seen{{static_cast<float>(start_.x - packet.origin.x),
               static_cast<float>(start_.y - packet.origin.y),
               static_cast<float>(start_.z - packet.origin.z)},
              in_floats(way_),
              in_floats(bend_),
              per_squared_way_,
              0};
    seen.slack = packet.slack(sum_of(seen.start) + sum_of(seen.way) + sum_of(seen.bend));
    return seen;
  }

  /// Calls visit(lane) for those of the first `used` lanes whose value is at most within(), the
  /// least one first, until it returns true, and returns whether it did.
  template <typename Within, typename Visit>
  CLEARWAY_HD static bool any_lane(const float (&values)[kMostPlaces], std::uint32_t used,
                                   Within within, Visit visit) {
    std::uint32_t open =
        lanes_within(values, WideBoxes::above(within())) & (0xffffffffU >> (32 - used));
    if (open == 0) return false;
    const std::uint32_t least = least_lane(values);
    for (std::uint32_t next = open >> least & 1 ? least : lowest_bit(open);;
         next = lowest_bit(open)) {
      open &= ~(1U << next);
      if (!(static_cast<double>(values[next]) > within()) && visit(next)) return true;
      if (open == 0) return false;
    }
  }

  /// Does any_place() for `used` places from `first` on, at most kMostPlaces.
  template <typename Within, typename Visit>
  CLEARWAY_HD bool visit_places(const FloatPacket& packet, std::uint32_t i, std::uint32_t first,
                                std::uint32_t used, float per_last, Within within,
                                Visit visit) const {
    float from_pose[kMostPlaces];
    from_places(packet, i, first, per_last, from_pose);
    return any_lane(from_pose, used, within, [&](std::uint32_t k) { return visit(first + k); });
  }

  /// Lower bound on the squared distance between triangle i and a hull, measured along `across`,
  /// which may be any direction; the bound is close if that is the shortest way between both.
  /// above: the least product of `across` and any place of the hull as seen from corner a.
  CLEARWAY_IN_CLONE CLEARWAY_HD static float from_hull(const FloatPacket& packet, std::uint32_t i,
                                                       const FloatVector& across, float above,
                                                       float slack) {
    const float length = FloatPacket::dot(across, across);
    const float gap = above - packet.farthest_along(i, across) - sum_of(across) * slack;
    const float square = gap / length * gap * kRoundedDown;
    return (gap > 0) & (length > kLeastSquaredDirection) ? square : 0;
  }

  CLEARWAY_IN_CLONE CLEARWAY_HD void to_all_triangles(const FloatPacket& packet,
                                                      float* squared) const {
    const Seen curve = seen_from(packet);
#ifdef __CUDA_ARCH__
    const std::uint32_t count = packet.count;
#else
    constexpr std::uint32_t count = FloatPacket::kMost;
#endif
    // Beside a triangle longer than the chord, any place of the chord is as good as another.
    const float share = packet.edge * packet.edge * curve.per_squared_way < 1 ? 1 : 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      const FloatVector seen = packet.centre_from(i, curve.start);
      const float beside = FloatPacket::dot(curve.way, seen) * curve.per_squared_way;
      const float t = 0.5F + share * (FloatPacket::clamped(beside) - 0.5F);
      const FloatVector from = packet.nearest(i, curve.at(t)).way;
      // Vector from the triangle to the place of the chord that is nearest to where `from` starts.
      const float slope = FloatPacket::dot(from, curve.way) * curve.per_squared_way;
      const FloatVector across = beyond(from, FloatPacket::clamped(t - slope) - t, curve.way);
      squared[i] = from_hull(packet, i, across, least_along(packet, i, curve, across), curve.slack);
    }
  }

  /// Does to_all_triangles() in vectors of the processor.
  void to_triangles_in_vectors(const FloatPacket& packet, float* squared) const;

  /// Computes from_parts(). A part from t - half to t + half lies within half |c'| of
  /// that place along the tangent at t, and within half^2 |bend| of the tangent.
  CLEARWAY_IN_CLONE CLEARWAY_HD void from_all_parts(const FloatPacket& packet, std::uint32_t i,
                                                    std::uint32_t length, float per_last,
                                                    float* squared) const {
    const Seen curve = seen_from(packet);
    const float middle = 0.5F * static_cast<float>(length - 1);
    const float half = middle * per_last + 0x1p-20F;  // covers the rounding of t
    float t[kMostPlaces];
    for (std::uint32_t k = 0; k < kMostPlaces; ++k) {
      t[k] = (static_cast<float>(k * length) + middle) * per_last;
    }
    for (std::uint32_t k = 0; k < kMostPlaces; ++k) {
      const FloatVector x = curve.at(t[k]);
      const FloatVector from = packet.nearest(i, x).way;
      const FloatVector tangent = beyond(curve.way, 1 - 2 * t[k], curve.bend);
      const float back = -FloatPacket::dot(from, tangent) * curve.per_squared_way;
      const float from_low = back > -half ? back : -half;
      const FloatVector across = beyond(from, from_low < half ? from_low : half, tangent);
      const float slope = size_of(FloatPacket::dot(across, tangent));
      const float bend = size_of(FloatPacket::dot(across, curve.bend));
      const float above =
          FloatPacket::dot(across, packet.from_corner(i, x)) - half * (slope + half * bend);
      squared[k] = from_hull(packet, i, across, above, curve.slack);
    }
  }

  /// Does from_all_parts() in vectors of the processor.
  void from_parts_in_vectors(const FloatPacket& packet, std::uint32_t i, std::uint32_t length,
                             float per_last, float* squared) const;

  /// Computes from_places(). As s is at least the error of the distance d, and |w| at least d, the
  /// square of d - s is at least d^2 - 2 s |w|.
  CLEARWAY_IN_CLONE CLEARWAY_HD void from_all_places(const FloatPacket& packet, std::uint32_t i,
                                                     std::uint32_t first, float per_last,
                                                     float* squared) const {
    const Seen curve = seen_from(packet);
    float t[kMostPlaces];
    for (std::uint32_t k = 0; k < kMostPlaces; ++k) {
      t[k] = static_cast<float>(first + k) * per_last;
    }
    for (std::uint32_t k = 0; k < kMostPlaces; ++k) {
      const FloatPacket::Nearest near = packet.nearest(i, curve.at(t[k]));
      const float least = near.squared - 2 * curve.slack * sum_of(near.way);
      squared[k] = least > 0 ? least : 0;
    }
  }

  /// Does from_all_places() in vectors of the processor.
  void from_places_in_vectors(const FloatPacket& packet, std::uint32_t i, std::uint32_t first,
                              float per_last, float* squared) const;

  CLEARWAY_HD static Vec3 beyond(const Vec3& from, double share, const Vec3& way) {
    return {from.x + share * way.x, from.y + share * way.y, from.z + share * way.z};
  }
  CLEARWAY_IN_CLONE CLEARWAY_HD static FloatVector beyond(const FloatVector& from, float share,
                                                          const FloatVector& way) {
    return {from.x + share * way.x, from.y + share * way.y, from.z + share * way.z};
  }

  /// The least dot product of v with any corner of the curve's hull, relative to corner a of
  /// triangle i.
  CLEARWAY_IN_CLONE CLEARWAY_HD static float least_along(const FloatPacket& packet, std::uint32_t i,
                                                         const Seen& curve, const FloatVector& v) {
    const float way = FloatPacket::dot(v, curve.way), bend = FloatPacket::dot(v, curve.bend);
    const float middle = 0.5F * (way + bend);
    const float least = way < 0 ? way : 0;
    return FloatPacket::dot(v, packet.from_corner(i, curve.start)) +
           (middle < least ? middle : least);
  }

  Vec3 start_, way_, bend_;
  float per_squared_way_ = 0;
};

}  // namespace clearway
