#include "core/swept_step.hpp"

#include <algorithm>
#include <cmath>

#include "core/sweep_bounds.hpp"
#include "core/predicate.hpp"

namespace clearway {
namespace {

/// The squared distance of e to the segment from a to b; its root is too large by at most
/// 20 u (|e - a| + |b - a|), and 0 stands for what overflows.
double squared_distance_to_segment(const Vec3& e, const Vec3& a, const Vec3& b) {
  const Vec3 ab = difference(b, a);
  const Vec3 ae = difference(e, a);
  const double n = rounded_dot(ae, ab);
  const double length = rounded_dot(ab, ab);
  if (!std::isfinite(n) || !std::isfinite(length)) return 0;
  const double g = length > 0 ? std::clamp(n / length, 0.0, 1.0) : 0.0;
  const Vec3 w = difference(ae, {g * ab.x, g * ab.y, g * ab.z});
  return rounded_dot(w, w);
}

}  // namespace

SweptStep::SweptStep(const Question& question, const MotionTree& motion, const ModelTree& model,
                     std::uint32_t pose, double rounding)
    : question_(question),
      model_(model),
      from_(question.poses[pose]),
      to_(question.poses[pose + 1]),
      stretch_(std::max(motion.pull_back(pose).greatest, motion.pull_back(pose + 1).greatest)),
      rounding_(rounding) {}

bool SweptStep::touches(const Vec3& e) const {
  return model_.any(
      [&](const Box& box) {
        return near(e, 0, box, half_width(box)) ? ModelTree::Step::kEnter : ModelTree::Step::kSkip;
      },
      [&](const Vec3& m) {
        const Vec3 a = transform(from_, m);
        return collides(e, a, question_.radius) ||
               collides_inside(e, a, transform(to_, m), question_.radius);
      });
}

bool SweptStep::may_touch(const Vec3& centre, double rho) const {
  return model_.any(
      [&](const Box& box) {
        const double half = half_width(box);
        if (!near(centre, rho, box, half)) return ModelTree::Step::kSkip;
        return half <= rho ? ModelTree::Step::kTake : ModelTree::Step::kEnter;
      },
      [](const Vec3&) { return true; });
}

/// Nowhere on the way is a point of the box farther from the box's centre.
double SweptStep::half_width(const Box& box) const { return stretch_ * half_diagonal(box); }

bool SweptStep::near(const Vec3& e, double rho, const Box& box, double half_width) const {
  const Vec3 centre = centre_of(box);
  const double squared =
      squared_distance_to_segment(e, transform(from_, centre), transform(to_, centre));
  return !farther(1, squared, question_.radius + rho + half_width + rounding_);
}

}  // namespace clearway
