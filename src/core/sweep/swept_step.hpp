#pragma once

#include <cmath>

#include "core/geometry/model_tree_ref.hpp"
#include "core/geometry/sweep_bounds.hpp"
#include "core/trajectory/motion_tree_ref.hpp"

namespace clearway {

/// The model on its way from one pose to the next, with every point on its straight segment. Finds
/// what of the model's tree comes near a point of the environment; long steps cost little more than
/// short ones.
class SweptStep {
 public:
  /// pose: not the last one. rounding: a bound in metres of every rounding of a test, as
  /// docs/design/numerics.md ("Between poses") asks for. What the refs point to must outlive this
  /// object.
  CLEARWAY_HD SweptStep(const MotionTreeRef& motion, const ModelTreeRef& model, std::uint32_t pose,
                        double radius, double rounding)
      : model_(model),
        from_(motion.poses[pose]),
        to_(motion.poses[pose + 1]),
        stretch_(greater_of(motion.inverse_poses[pose].greatest,
                            motion.inverse_poses[pose + 1].greatest)),
        radius_(radius),
        rounding_(rounding) {}

  /// Whether e collides with a model point on the way from the pose to the next, both included.
  CLEARWAY_HD bool touches(const Vec3& e) const {
    return model_.any(
        [&](const Box& box) {
          return near(e, 0, box, half_width(box)) ? ModelTreeRef::Step::kEnter
                                                  : ModelTreeRef::Step::kSkip;
        },
        [&](const Vec3& m) {
          return collides_on_way(e, transform(from_, m), transform(to_, m), radius_);
        });
  }

  /// False only if no point within rho of `centre` collides on the way or at either of its ends.
  CLEARWAY_HD bool may_touch(const Vec3& centre, double rho) const {
    return model_.any(
        [&](const Box& box) {
          const double half = half_width(box);
          if (!near(centre, rho, box, half)) return ModelTreeRef::Step::kSkip;
          return half <= rho ? ModelTreeRef::Step::kTake : ModelTreeRef::Step::kEnter;
        },
        [](const Vec3&) { return true; });
  }

 private:
  /// Bound on the distance of a point of the box from the box's centre, anywhere on the way.
  CLEARWAY_HD double half_width(const Box& box) const { return stretch_ * half_diagonal(box); }

  CLEARWAY_HD bool near(const Vec3& e, double rho, const Box& box, double half_width) const {
    const Vec3 centre = box.centre();
    const double squared =
        squared_distance_to_segment(e, transform(from_, centre), transform(to_, centre));
    return !farther(1, squared, radius_ + rho + half_width + rounding_);
  }

  /// The squared distance of e to the segment from a to b. Its root is too large by at most 20 u
  /// (|e - a| + |b - a|); it is 0 if the computation overflows.
  CLEARWAY_HD static double squared_distance_to_segment(const Vec3& e, const Vec3& a,
                                                        const Vec3& b) {
    const Vec3 ab = difference(b, a);
    const Vec3 ae = difference(e, a);
    const double n = rounded_dot(ae, ab);
    const double length = rounded_dot(ab, ab);
    if (!(std::fabs(n) <= kLargestDouble && length <= kLargestDouble)) return 0;
    double g = length > 0 ? n / length : 0.0;
    if (!(g > 0)) g = 0;
    if (g > 1) g = 1;
    const Vec3 w = difference(ae, {g * ab.x, g * ab.y, g * ab.z});
    return rounded_dot(w, w);
  }

  const ModelTreeRef& model_;
  const Pose& from_;
  const Pose& to_;
  double stretch_;
  double radius_;
  double rounding_;
};

}  // namespace clearway
