#pragma once

#include <cmath>
#include <cstdint>

#include "core/geometry/box.hpp"
#include "core/geometry/sweep_bounds.hpp"
#include "core/geometry/wide_tree_ref.hpp"
#include "core/trajectory/motion_tree_ref.hpp"

namespace clearway {

/// The parabola c(t) = start + t way + t (1 - t) bend, t from 0 to 1, on which an environment point
/// moves as seen from the model while the model moves through the poses of a node. If its speed
/// changes too much to bound distances, only its middle is kept (docs/design/numerics.md,
/// "Clearance").
class PointCurve {
 public:
  /// reach: model points farther than this from the curve do not matter.
  CLEARWAY_HD PointCurve(const MotionTreeRef& motion, const MotionNode& node, const Vec3& e,
                         double reach)
      : way_{}, bend_{} {
    const MotionParabola through(node);
    start_ = motion.inverse_poses[through.middle].apply(e);
    if (node.count == 1) return;
    const Vec3 first =
        through.middle == through.first ? start_ : motion.inverse_poses[through.first].apply(e);
    const Vec3 last = motion.inverse_poses[through.last].apply(e);
    const Vec3 way = difference(last, first);
    const Vec3 bend = through.bend(first, way, start_);
    const double squared_way = squared_length(way.x, way.y, way.z);
    const double length = std::sqrt(squared_way);
    const double bent = std::sqrt(squared_length(bend.x, bend.y, bend.z));
    const double slowest = length - bent;
    const double convexity = slowest * slowest - 2 * bent * (reach + length + bent);
    if (slowest > 0 && convexity > 0.25 * squared_way && squared_way > kLeastSquaredWay) {
      start_ = first;
      way_ = way;
      bend_ = bend;
      per_squared_way_ = 1 / squared_way;
      convexity_ = convexity * (1 - 128 * kUnitRoundoff);
      per_convexity_ = 1 / convexity_;
    } else {
      beside_ = (length + bent) * kRoundedUp;
    }
  }

  /// Greatest distance of the true parabola from this one.
  CLEARWAY_HD double beside() const { return beside_; }

  CLEARWAY_HD Box box() const { return MotionParabola::box(start_, way_, bend_); }

  /// Lower bounds on the squared distances from the curve to the points of a packet, for points
  /// within reach.
  CLEARWAY_HD void to_points(const PointPacket& packet,
                             double (&squared)[PointPacket::kMost]) const {
#ifdef __CUDA_ARCH__
    to_all_points(packet, squared);
#else
    to_points_in_vectors(packet, squared);
#endif
  }

  /// The places within sqrt(squared) of m lie between `low` and `high`; low > high if there are
  /// none.
  struct Places {
    double nearest, low, high;
  };

  CLEARWAY_HD Places places(const Vec3& m, double squared) const {
    if (convexity_ == 0) return {0.5, 0, 1};
    double t = near_place(m);
    const From near = at(m, t);
    t = clamped(t + near.gain * per_convexity_);
    const From from = at(m, t);
    // The squared distance at t + h is at least from.squared - 2 h from.gain + h h convexity.
    const double open = from.gain * from.gain - convexity_ * (from.squared - squared);
    if (open < 0) return {t, 1, 0};
    const double half = std::sqrt(open);
    return {t, t + (from.gain - half) * per_convexity_, t + (from.gain + half) * per_convexity_};
  }

 private:
  /// With a smaller squared way, squares of squares of the way lose digits to underflow.
  static constexpr double kLeastSquaredWay = 1e-140;

  /// How a model point is seen from a place of the curve.
  struct From {
    double squared;  ///< squared distance
    double gain;     ///< minus half of the slope of `squared` over t
  };

  CLEARWAY_HD void to_all_points(const PointPacket& packet, double* squared) const {
    for (std::uint32_t i = 0; i < PointPacket::kMost; ++i) {
      const Vec3 m{packet.at[0][i], packet.at[1][i], packet.at[2][i]};
      const From from = at(m, near_place(m));
      squared[i] = from.squared - from.gain * from.gain * per_convexity_;
    }
  }

  /// Does to_all_points() in vectors of the processor.
  void to_points_in_vectors(const PointPacket& packet, double* squared) const;

  CLEARWAY_HD static double clamped(double t) {
    const double from_0 = t > 0 ? t : 0;
    return from_0 < 1 ? from_0 : 1;
  }

  /// The t of the place of the chord that is nearest to m.
  CLEARWAY_HD double near_place(const Vec3& m) const {
    return clamped(
        (way_.x * (m.x - start_.x) + way_.y * (m.y - start_.y) + way_.z * (m.z - start_.z)) *
        per_squared_way_);
  }

  CLEARWAY_HD From at(const Vec3& m, double t) const {
    const double rest = 1 - t, slope = rest - t;
    const double x = m.x - start_.x - t * (way_.x + rest * bend_.x);
    const double y = m.y - start_.y - t * (way_.y + rest * bend_.y);
    const double z = m.z - start_.z - t * (way_.z + rest * bend_.z);
    return {x * x + y * y + z * z, x * (way_.x + slope * bend_.x) + y * (way_.y + slope * bend_.y) +
                                       z * (way_.z + slope * bend_.z)};
  }

  Vec3 start_, way_, bend_;
  double per_squared_way_ = 0;
  double convexity_ = 0;  ///< at most half the second derivative of the squared distance
  double per_convexity_ = 0;
  double beside_ = 0;
};

}  // namespace clearway
