#include "core/trajectory/motion_curves.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "core/geometry/sweep_bounds.hpp"

namespace clearway {
namespace {

/// Greatest motion of a curve as a share of the model's size. The boxes of longer curves are so
/// wide that the distance to them says little (measured).
constexpr double kMostMotion = 0.1;
/// Greatest error of a useful curve as a share of the spacing of the model's points, and greatest
/// gap between its poses, in units of about two such spacings.
constexpr double kMostError = 0.125, kMostGap = 1;

/// The box, in the model's frame, of places that may be near the model at a pose.
struct Region {
  Vec3 centre, half;
};

Region region_of(const Box& model, double beyond) {
  Region region{model.centre(), {}};
  for (int k = 0; k < 3; ++k) region.half[k] = (model.hi[k] - model.lo[k]) / 2 + beyond;
  return region;
}

Vec3 product(const double (&a)[9], const Vec3& v) {
  return {a[0] * v.x + a[1] * v.y + a[2] * v.z, a[3] * v.x + a[4] * v.y + a[5] * v.z,
          a[6] * v.x + a[7] * v.y + a[8] * v.z};
}

/// Where `other` pulls back the place that `pose` pulls back to y.
Vec3 seen_by(const InversePose& other, const Pose& pose, const Vec3& y) {
  const Vec3 turned = product(pose.rotation, y);
  return product(other.inverse, {turned.x + (pose.translation[0] - other.translation[0]),
                                 turned.y + (pose.translation[1] - other.translation[1]),
                                 turned.z + (pose.translation[2] - other.translation[2])});
}

/// Bound on the distance between the curve at place t and any place that `pose` pulls back into the
/// region. The difference is affine in the place.
double distance_from_curve(const MotionTree& motion, const MotionParabola& curve, double t,
                           const Pose& pose, const Region& region) {
  const double height = curve.height();
  const double bend = height > 0 ? t * (1 - t) / height : 0;
  const double share[3] = {1 - t - bend * (1 - curve.middle_place), bend,
                           t - bend * curve.middle_place};
  const std::uint32_t through[3] = {curve.first, curve.middle, curve.last};
  Vec3 off = region.centre;
  double inverse[9] = {};
  for (int i = 0; i < 3; ++i) {
    const InversePose& back = motion.inverse_pose(through[i]);
    const Vec3 seen = seen_by(back, pose, region.centre);
    for (int k = 0; k < 3; ++k) off[k] -= share[i] * seen[k];
    for (int k = 0; k < 9; ++k) inverse[k] += share[i] * back.inverse[k];
  }
  double distance = length(off);
  for (int k = 0; k < 3; ++k) {
    const double* r = pose.rotation + k;
    const Vec3 column = product(inverse, {r[0], r[3], r[6]});
    const Vec3 turned{column.x - (k == 0), column.y - (k == 1), column.z - (k == 2)};
    distance += length(turned) * region.half[k];
  }
  return distance;
}

float rounded_up(double value) {
  return std::nextafterf(static_cast<float>(value * kRoundedUp),
                         std::numeric_limits<float>::infinity());
}

}  // namespace

MotionCurves::MotionCurves(const MotionTree& motion, const Box& model, double reach, double spacing)
    : motion_(&motion),
      model_(model),
      reach_(reach),
      spacing_(spacing),
      curves_(motion.nodes().size()) {
  const std::span<const MotionNode> nodes = motion.nodes();
  const std::span<const Pose> poses = motion.poses();
  const double most_motion = kMostMotion * 2 * half_diagonal(model);
  for (std::size_t at = nodes.size(); at-- > 0;) {
    const MotionNode& node = nodes[at];
    MotionCurve& curve = curves_[at];
    if (node.count == 1) {
      curve = {MotionCurve::kEqual,
               std::nextafterf(static_cast<float>(motion.inverse_pose(node.first).least), 0.0F)};
      continue;
    }
    const MotionCurve &earlier = curves_[at + 1], &later = curves_[node.later];
    const bool equal = earlier.is_one_place() && later.is_one_place() &&
                       poses[node.first] == poses[nodes[node.later].first];
    const bool is_wide = node.delta > most_motion || node.delta > kMostGap * spacing * node.count;
    curve.error = equal ? MotionCurve::kEqual : is_wide ? MotionCurve::kNone : kUnknown;
    curve.least = std::min(earlier.least, later.least);
  }
}

MotionCurves::MotionCurves(const MotionTree& motion, const Box& model, double reach, double spacing,
                           int threads)
    : MotionCurves(motion, model, reach, spacing) {
#pragma omp parallel for schedule(dynamic, 64) num_threads(threads)
  for (std::size_t node = 0; node < curves_.size(); ++node) at(static_cast<std::uint32_t>(node));
}

/// Two threads that compute the same curve get the same result.
MotionCurve MotionCurves::at(std::uint32_t node) const {
  MotionCurve& curve = curves_[node];
  const std::atomic_ref shared(curve.error);
  float error = shared.load(std::memory_order_relaxed);
  if (std::isnan(error)) {
    error = error_of(motion_->nodes()[node], static_cast<double>(curve.least));
    shared.store(error, std::memory_order_relaxed);
  }
  return {error, curve.least};
}

float MotionCurves::error_of(const MotionNode& node, double least) const {
  const Region region = region_of(model_, reach_ / least * kRoundedUp);
  const MotionParabola parabola(node);
  const double most_error = kMostError * spacing_;
  double error = 0;
  for (std::uint32_t i = parabola.first + 1; i < parabola.last && error <= most_error; ++i) {
    const double place = static_cast<double>(i - parabola.first) / (node.count - 1);
    const double here = distance_from_curve(*motion_, parabola, place, motion_->poses()[i], region);
    if (!(here <= error)) error = here;
  }
  return error <= most_error ? rounded_up(error) : MotionCurve::kNone;
}

}  // namespace clearway
