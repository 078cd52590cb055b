#pragma once

#include <cstdint>

#include "core/geometry/box.hpp"
#include "core/geometry/sweep_bounds.hpp"
#include "core/geometry/wide_tree_ref.hpp"
#include "core/trajectory/motion_tree_ref.hpp"
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
    if (squared_way > kLeastSquaredWay) per_squared_way_ = 1 / squared_way;
    const double size = squared_way + squared_length(bend_.x, bend_.y, bend_.z);
    rounding_ = 32 * kUnitRoundoff * size;
  }

  /// The convex hull of the curve, and its box.
  CLEARWAY_HD PlaceHull hull() const {
    return {MotionParabola::box(start_, way_, bend_),
            {start_, beyond(start_, 1, way_), beyond(beyond(start_, 0.5, way_), 0.5, bend_)}};
  }

  /// Lower bounds of the squared distances from the curve to the triangles of a packet.
  CLEARWAY_HD void to_triangles(const TrianglePacket& packet,
                                double (&squared)[TrianglePacket::kMost]) const {
#ifdef __CUDA_ARCH__
    to_all_triangles(packet, squared);
#else
    to_triangles_in_vectors(packet, squared);
#endif
  }

  /// The t of a place of the curve that is near the triangle.
  CLEARWAY_HD double place(const TrianglePacket& packet, std::uint32_t i) const {
    const Vec3 x = at(0.5);
    return place_near(difference(x, packet.nearest(i, x).way));
  }

  static constexpr std::uint32_t kMostPlaces = 8;  ///< number of places that are computed together

  /// Lower bounds of the squared distances from a triangle to parts of the curve: part k has
  /// `length` places from (k length) per_last on.
  CLEARWAY_HD void from_parts(const TrianglePacket& packet, std::uint32_t i, std::uint32_t length,
                              double per_last, double (&squared)[kMostPlaces]) const {
#ifdef __CUDA_ARCH__
    from_all_parts(packet, i, length, per_last, squared);
#else
    from_parts_in_vectors(packet, i, length, per_last, squared);
#endif
  }

  /// Calls visit(k) for those of `count` places that may be within the square root of within() of
  /// the triangle, until it returns true, and returns whether it did. Place k is at k / (count -
  /// 1). The place that is likely nearest comes first, whatever within() is.
  template <typename Within, typename Visit>
  CLEARWAY_HD bool any_place(const TrianglePacket& packet, std::uint32_t i, std::uint32_t count,
                             Within within, Visit visit) const {
    const double per_last = 1.0 / (count - 1);
    const auto nearest = static_cast<std::uint32_t>(place(packet, i) * (count - 1) + 0.5);
    if (visit(nearest)) return true;
    constexpr std::uint32_t kMost = kMostPlaces;
    const std::uint32_t length = count > kMost * kMost ? (count - 1) / kMost + 1 : kMost;
    double from_part[kMost];
    from_parts(packet, i, length, per_last, from_part);
    for (std::uint32_t part = 0; part < kMost && part * length < count; ++part) {
      if (from_part[part] > within()) continue;
      const std::uint32_t begin = part * length, left = count - begin;
      double from_pose[kMost];
      for (std::uint32_t k = 0; k < (length < left ? length : left); ++k) {
        if (k % kMost == 0) from_places(packet, i, begin + k, per_last, from_pose);
        const bool is_open = !(from_pose[k % kMost] > within());
        if (is_open && begin + k != nearest && visit(begin + k)) return true;
      }
    }
    return false;
  }

  /// The squares of the distances from a triangle to the places (first + k) per_last.
  CLEARWAY_HD void from_places(const TrianglePacket& packet, std::uint32_t i, std::uint32_t first,
                               double per_last, double (&squared)[kMostPlaces]) const {
#ifdef __CUDA_ARCH__
    from_all_places(packet, i, first, per_last, squared);
#else
    from_places_in_vectors(packet, i, first, per_last, squared);
#endif
  }

 private:
  /// A way with a smaller square is as good as a single place.
  static constexpr double kLeastSquaredWay = 1e-140;

  CLEARWAY_IN_CLONE CLEARWAY_HD void to_all_triangles(const TrianglePacket& packet,
                                                      double* squared) const {
    for (std::uint32_t i = 0; i < TrianglePacket::kMost; ++i) {
      const double t = place(packet, i);
      const Vec3 x = at(t);
      const TrianglePacket::Nearest from = packet.nearest(i, x);
#ifdef __CUDA_ARCH__  // where the closer bound costs more than it saves (measured)
      squared[i] = packet.from_nearest_hull(i, from.squared, along_hull(from.way, t));
#else
      // Vector from the triangle to the place of the chord that is nearest to where `from.way`
      // starts.
      const double slope = TrianglePacket::dot(from.way, way_) * per_squared_way_;
      const Vec3 across = beyond(from.way, TrianglePacket::clamped(t - slope) - t, way_);
      squared[i] = packet.from_hull(i, x, from.squared, across, along_hull(across, t));
#endif
    }
  }

  /// Does to_all_triangles() in vectors of the processor.
  void to_triangles_in_vectors(const TrianglePacket& packet, double* squared) const;

  /// Computes from_parts(). A part from t - half to t + half lies within half |c'| along its
  /// tangent at t and within half^2 |bend| beside that.
  CLEARWAY_IN_CLONE CLEARWAY_HD void from_all_parts(const TrianglePacket& packet, std::uint32_t i,
                                                    std::uint32_t length, double per_last,
                                                    double* squared) const {
    const double middle = 0.5 * (length - 1);
    const double half = middle * per_last * (1 + 1e-9);
    double t[kMostPlaces];
    for (std::uint32_t k = 0; k < kMostPlaces; ++k) {
      t[k] = (k * length + middle) * per_last;
    }
    for (std::uint32_t k = 0; k < kMostPlaces; ++k) {
      const Vec3 x = at(t[k]);
      const TrianglePacket::Nearest from = packet.nearest(i, x);
#ifdef __CUDA_ARCH__
      const double bend = TrianglePacket::dot(from.way, bend_);
      const double slope = TrianglePacket::dot(from.way, way_) + (1 - 2 * t[k]) * bend;
      const double most = (slope < 0 ? -slope : slope) + half * (bend < 0 ? -bend : bend);
      squared[k] = packet.from_nearest_hull(i, from.squared, -half * most - rounding_);
#else
      const Vec3 tangent = beyond(way_, 1 - 2 * t[k], bend_);
      const double back = -TrianglePacket::dot(from.way, tangent) * per_squared_way_;
      const double from_low = back > -half ? back : -half;
      const Vec3 across = beyond(from.way, from_low < half ? from_low : half, tangent);
      const double slope = TrianglePacket::dot(across, tangent);
      const double bend = TrianglePacket::dot(across, bend_);
      const double most = (slope < 0 ? -slope : slope) + half * (bend < 0 ? -bend : bend);
      squared[k] = packet.from_hull(i, x, from.squared, across, -half * most - rounding_);
#endif
    }
  }

  /// Does from_all_parts() in vectors of the processor.
  void from_parts_in_vectors(const TrianglePacket& packet, std::uint32_t i, std::uint32_t length,
                             double per_last, double* squared) const;

  CLEARWAY_IN_CLONE CLEARWAY_HD void from_all_places(const TrianglePacket& packet, std::uint32_t i,
                                                     std::uint32_t first, double per_last,
                                                     double* squared) const {
    double t[kMostPlaces];
    for (std::uint32_t k = 0; k < kMostPlaces; ++k) t[k] = (first + k) * per_last;
    for (std::uint32_t k = 0; k < kMostPlaces; ++k) {
      squared[k] = packet.nearest(i, at(t[k])).squared;
    }
  }

  /// Does from_all_places() in vectors of the processor.
  void from_places_in_vectors(const TrianglePacket& packet, std::uint32_t i, std::uint32_t first,
                              double per_last, double* squared) const;

  CLEARWAY_HD Vec3 at(double t) const {
    const double rest = 1 - t;
    return {start_.x + t * (way_.x + rest * bend_.x), start_.y + t * (way_.y + rest * bend_.y),
            start_.z + t * (way_.z + rest * bend_.z)};
  }

  CLEARWAY_HD static Vec3 beyond(const Vec3& from, double share, const Vec3& way) {
    return {from.x + share * way.x, from.y + share * way.y, from.z + share * way.z};
  }

  /// The t of the place of the chord that is nearest to m.
  CLEARWAY_HD double place_near(const Vec3& m) const {
    return TrianglePacket::clamped(TrianglePacket::dot(way_, difference(m, start_)) *
                                   per_squared_way_);
  }

  /// Lower bound of the product of v and any corner of the hull as seen from at(t); at most 0.
  CLEARWAY_HD double along_hull(const Vec3& v, double t) const {
    const double way = TrianglePacket::dot(v, way_), bend = TrianglePacket::dot(v, bend_);
    const double here = t * (way + (1 - t) * bend);
    const double middle = 0.5 * (way + bend);
    double least = way < 0 ? way : 0;
    least = middle < least ? middle : least;
    least -= here;
    return (least < 0 ? least : 0) - rounding_;
  }

  Vec3 start_, way_, bend_;
  double rounding_ = 0;  ///< bound for products with a way, square metres
  double per_squared_way_ = 0;
};

}  // namespace clearway
