#include "core/trajectory/motion_chords.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/sweep_bounds.hpp"

namespace clearway {
namespace {

/// Longer ranges are not looked at as a whole: what a chord saves grows no more.
constexpr std::uint32_t kMostPoses = 1024;
/// No chord is of use that is wrong by more than this share of the spacing of the model's points,
/// or that has gaps of about twice this many spacings between its poses.
constexpr double kMostError = 0.125, kMostGap = 1;

/// The box of what may be near the model at a pose, in the model's frame.
struct Region {
  Vec3 centre, half;
};

Region region_of(const Box& model, double beyond) {
  Region region{centre_of(model), {}};
  for (int k = 0; k < 3; ++k) region.half[k] = (model.hi[k] - model.lo[k]) / 2 + beyond;
  return region;
}

Vec3 product(const double (&a)[9], const Vec3& v) {
  return {a[0] * v.x + a[1] * v.y + a[2] * v.z, a[3] * v.x + a[4] * v.y + a[5] * v.z,
          a[6] * v.x + a[7] * v.y + a[8] * v.z};
}

double length(const Vec3& v) { return std::sqrt(squared_length(v.x, v.y, v.z)); }

/// Where a place that `pose` pulls back to y is pulled back to by `other`.
Vec3 seen_by(const InversePose& other, const Pose& pose, const Vec3& y) {
  const Vec3 turned = product(pose.rotation, y);
  return product(other.inverse, {turned.x + (pose.translation[0] - other.translation[0]),
                                 turned.y + (pose.translation[1] - other.translation[1]),
                                 turned.z + (pose.translation[2] - other.translation[2])});
}

/// How far any place that `pose` pulls back into the region is there from the chord between where
/// `first` and `last` pull it back to: the place on the chord that is best for the centre serves
/// all, and the difference is affine.
double distance_from_chord(const InversePose& first, const InversePose& last, const Pose& pose,
                           const Region& region) {
  const Vec3& y = region.centre;
  const Vec3 a = seen_by(first, pose, y), b = seen_by(last, pose, y);
  const Vec3 v{b.x - a.x, b.y - a.y, b.z - a.z}, w{y.x - a.x, y.y - a.y, y.z - a.z};
  const double squared = squared_length(v.x, v.y, v.z);
  const double along = v.x * w.x + v.y * w.y + v.z * w.z;
  const double t = squared > 0 ? std::clamp(along / squared, 0.0, 1.0) : 0.0;
  double distance = length({w.x - t * v.x, w.y - t * v.y, w.z - t * v.z});
  double inverse[9];
  for (int k = 0; k < 9; ++k) inverse[k] = (1 - t) * first.inverse[k] + t * last.inverse[k];
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

MotionChords::MotionChords(const MotionTree& motion, const Box& model, double reach, double spacing,
                           int threads)
    : chords_(motion.nodes().size()) {
  const std::span<const MotionNode> nodes = motion.nodes();
  const std::span<const Pose> poses = motion.poses();
  for (std::size_t at = nodes.size(); at-- > 0;) {
    const MotionNode& node = nodes[at];
    MotionChord& chord = chords_[at];
    if (node.count == 1) {
      chord = {MotionChord::kEqual,
               std::nextafterf(static_cast<float>(motion.inverse_pose(node.first).least), 0.0F)};
      continue;
    }
    const MotionChord &earlier = chords_[at + 1], &later = chords_[node.later];
    const bool equal = earlier.is_one_place() && later.is_one_place() &&
                       poses[node.first] == poses[nodes[node.later].first];
    chord.error = MotionChord::kNone;
    if (equal) chord.error = MotionChord::kEqual;
    chord.least = std::min(earlier.least, later.least);
  }
#pragma omp parallel for schedule(dynamic, 64) num_threads(threads)
  for (std::size_t at = 0; at < nodes.size(); ++at) {
    const MotionNode& node = nodes[at];
    MotionChord& chord = chords_[at];
    if (node.count > kMostPoses || chord.is_one_place()) continue;
    if (node.delta > kMostGap * spacing * node.count) continue;
    const Region region = region_of(model, reach / static_cast<double>(chord.least) * kRoundedUp);
    const std::uint32_t last = node.first + node.count - 1;
    const double most_error = kMostError * spacing;
    double error = 0;
    for (std::uint32_t i = node.first + 1; i < last && error <= most_error; ++i) {
      const double here = distance_from_chord(motion.inverse_pose(node.first),
                                              motion.inverse_pose(last), poses[i], region);
      if (!(here <= error)) error = here;
    }
    if (error <= most_error) chord.error = rounded_up(error);
  }
}

}  // namespace clearway
