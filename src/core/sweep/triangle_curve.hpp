#pragma once

#include <cstdint>

#include "core/geometry/box.hpp"
#include "core/geometry/sweep_bounds.hpp"
#include "core/geometry/triangle_packet.hpp"
#include "core/trajectory/motion_tree_ref.hpp"
#include "core/util/macros.hpp"

namespace clearway {

/// The parabola c(t) = start + t way + t (1 - t) bend that a point moves along, seen from the
/// model, while the model moves through the poses of a node, against triangles. It lies in the
/// convex hull of c(0), c(1) and the place where its tangents there meet.
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

  CLEARWAY_HD Box box() const { return MotionParabola::box(start_, way_, bend_); }

  /// At most the squares of the distances to the triangles of a packet.
  CLEARWAY_HD void to_triangles(const TrianglePacket& packet,
                                double (&squared)[TrianglePacket::kMost]) const {
#ifdef __CUDA_ARCH__
    to_all_triangles(packet, squared);
#else
    to_triangles_in_vectors(packet, squared);
#endif
  }

  /// The t of a place that is near the triangle.
  CLEARWAY_HD double place(const TrianglePacket& packet, std::uint32_t i) const {
    const Vec3 x = at(0.5);
    return place_near(difference(x, packet.nearest(i, x).way));
  }

  static constexpr std::uint32_t kMostPlaces = 8;  ///< worked on together

  /// At most the squares of the distances from a triangle to parts of the curve: number k has
  /// `length` places from (k length) per_last on.
  CLEARWAY_HD void from_parts(const TrianglePacket& packet, std::uint32_t i, std::uint32_t length,
                              double per_last, double (&squared)[kMostPlaces]) const {
#ifdef __CUDA_ARCH__
    from_all_parts(packet, i, length, per_last, squared);
#else
    from_parts_in_vectors(packet, i, length, per_last, squared);
#endif
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
  /// Where the way is shorter, it is as good as a place.
  static constexpr double kLeastSquaredWay = 1e-140;

  CLEARWAY_IN_CLONE CLEARWAY_HD void to_all_triangles(const TrianglePacket& packet,
                                                      double* squared) const {
    for (std::uint32_t i = 0; i < TrianglePacket::kMost; ++i) {
      const double t = place(packet, i);
      const Vec3 x = at(t);
      const TrianglePacket::Nearest from = packet.nearest(i, x);
      squared[i] = packet.from_hull(i, from, along_hull(from.way, t));
    }
  }

  /// The same in vectors of the processor.
  void to_triangles_in_vectors(const TrianglePacket& packet, double* squared) const;

  /// A part from t - half to t + half lies within half |c'| along its tangent at t and half^2
  /// |bend| beside that.
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
      const TrianglePacket::Nearest from = packet.nearest(i, at(t[k]));
      const double bend = TrianglePacket::dot(from.way, bend_);
      const double slope = TrianglePacket::dot(from.way, way_) + (1 - 2 * t[k]) * bend;
      const double most = (slope < 0 ? -slope : slope) + half * (bend < 0 ? -bend : bend);
      squared[k] = packet.from_hull(i, from, -half * most - rounding_);
    }
  }

  /// The same in vectors of the processor.
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

  /// The same in vectors of the processor.
  void from_places_in_vectors(const TrianglePacket& packet, std::uint32_t i, std::uint32_t first,
                              double per_last, double* squared) const;

  CLEARWAY_HD Vec3 at(double t) const {
    const double rest = 1 - t;
    return {start_.x + t * (way_.x + rest * bend_.x), start_.y + t * (way_.y + rest * bend_.y),
            start_.z + t * (way_.z + rest * bend_.z)};
  }

  /// Of the chord.
  CLEARWAY_HD double place_near(const Vec3& m) const {
    return TrianglePacket::clamped(TrianglePacket::dot(way_, difference(m, start_)) *
                                   per_squared_way_);
  }

  /// At most the least product of v and a corner of the hull as seen from at(t), and at most 0.
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
  double rounding_ = 0;  ///< square metres, of products with a way
  double per_squared_way_ = 0;
};

}  // namespace clearway
