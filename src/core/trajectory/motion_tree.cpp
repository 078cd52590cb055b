#include "core/trajectory/motion_tree.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "core/geometry/rigid.hpp"
#include "core/geometry/sweep_bounds.hpp"

namespace clearway {
namespace {

/// Longest range whose delta is computed pose by pose; longer ranges get it from nodes kLevels
/// below.
constexpr std::uint32_t kExactPoses = 8;
constexpr int kLevels = 4;

/// Bound on the determinant: between this and its reciprocal, nothing that matters to the bound on
/// the inverse's rounding under- or overflows.
constexpr double kLeastDeterminant = 1e-270;

using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

InversePose inverse_pose_of(const Pose& pose) {
  const RowMajor inverse = Eigen::Map<const RowMajor>(pose.rotation).inverse();
  Pose inverse_pose{};
  std::copy(inverse.data(), inverse.data() + 9, inverse_pose.rotation);
  InversePose out{};
  std::copy(inverse.data(), inverse.data() + 9, out.inverse);
  std::copy(pose.translation, pose.translation + 3, out.translation);
  out.greatest = greatest_stretch_bound(pose);
  // The singular values of the inverse are the reciprocals. The inverse by cofactors errs by less
  // than 20 u condition^2 (docs/design/numerics.md, "Sweep").
  const double inverse_greatest = greatest_stretch_bound(inverse_pose);
  const double condition = out.greatest * inverse_greatest;
  out.least = 1 / (inverse_greatest * (1 + 64 * kUnitRoundoff * (1 + condition * condition)));
  const double determinant = std::abs(Eigen::Map<const RowMajor>(pose.rotation).determinant());
  if (!(determinant > kLeastDeterminant && determinant < 1 / kLeastDeterminant)) out.least = 0;
  return out;
}

}  // namespace

MotionTree::MotionTree(std::span<const Pose> poses, const Box& model, bool between_poses,
                       int threads)
    : poses_(poses), between_poses_(between_poses) {
  if (poses.empty()) return;
  inverse_poses_.resize(poses.size());
  travelled_.resize(poses.size());
#pragma omp parallel for schedule(static) num_threads(threads)
  for (std::size_t i = 0; i < poses.size(); ++i) {
    inverse_poses_[i] = inverse_pose_of(poses[i]);
    if (i > 0) travelled_[i] = displacement_bound(model, poses[i - 1], poses[i]);
  }
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (i > 0) travelled_[i] += travelled_[i - 1];
    condition_ = std::max(condition_, inverse_poses_[i].greatest / inverse_poses_[i].least);
    for (const double p : poses[i].translation) magnitude_ = std::max(magnitude_, std::abs(p));
  }
  for (const InversePose& p : inverse_poses_) greatest_ = std::max(greatest_, p.greatest);
  const Vec3 reach = reach_of(model);
  magnitude_ += 2 * greatest_ * std::max({reach.x, reach.y, reach.z});
  nodes_.reserve(2 * poses.size());
  add(0, static_cast<std::uint32_t>(poses.size()));
  travelled_ = {};
  find_deltas(model, threads);
}

/// Computes the delta of every node from those of the nodes below it, which come after it: first in
/// subtrees, many at a time, and then in the nodes above them.
void MotionTree::find_deltas(const Box& model, int threads) {
  constexpr std::uint32_t kSubtreePoses = 512;
  std::vector<std::uint32_t> above, subtrees;
  for (std::uint32_t node = 0; node < nodes_.size();) {
    const bool whole = nodes_[node].count <= kSubtreePoses;
    (whole ? subtrees : above).push_back(node);
    node += whole ? 2 * nodes_[node].count - 1 : 1;
  }
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads)
  for (const std::uint32_t first : subtrees) {
    for (std::uint32_t node = first + 2 * nodes_[first].count - 1; node-- > first;) {
      nodes_[node].delta = delta_of(node, model);
    }
  }
  for (std::size_t i = above.size(); i-- > 0;) {
    nodes_[above[i]].delta = delta_of(above[i], model);
  }
}

void MotionTree::add(std::uint32_t first, std::uint32_t count) {
  const std::size_t self = nodes_.size();
  const auto begin = travelled_.begin() + first;
  const double half = (*begin + *(begin + count - 1)) / 2;
  const auto at = std::lower_bound(begin, begin + count, half);
  auto mid = static_cast<std::uint32_t>(at - begin);
  // A stop, which has no motion to halve, is divided in the middle.
  if (!(travelled_[first] < travelled_[first + count - 1])) mid = count / 2;
  mid = std::min(mid, count - 1);
  nodes_.push_back({first, count, first + mid, 0, 0});
  if (count == 1) return;
  const std::uint32_t split = std::clamp(mid, 1U, count - 1);
  add(first, split);
  nodes_[self].later = static_cast<std::uint32_t>(nodes_.size());
  add(first + split, count - split);
}

double MotionTree::delta_of(std::uint32_t node, const Box& model) const {
  const MotionNode& n = nodes_[node];
  if (n.count > kExactPoses) return delta_below(node, n.mid, kLevels, model);
  double delta = 0;
  const bool moves_on = between_poses_ && n.first + n.count < poses_.size();
  for (std::uint32_t i = n.first; i < n.first + n.count + (moves_on ? 1 : 0); ++i) {
    if (i != n.mid) delta = std::max(delta, displacement_bound(model, poses_[n.mid], poses_[i]));
  }
  // Between poses, a computed hit may lie outside the radius by 4 u times the step's length, which
  // is at most 2 delta (docs/design/numerics.md).
  return between_poses_ ? delta * kRoundedUp : delta;
}

/// Upper bound on how far any model point moves from pose `mid` to any pose of the node, computed
/// from the nodes `levels` below it, whose deltas are known.
double MotionTree::delta_below(std::uint32_t node, std::uint32_t mid, int levels,
                               const Box& model) const {
  const MotionNode& n = nodes_[node];
  if (levels > 0 && n.count > 1) {
    return std::max(delta_below(node + 1, mid, levels - 1, model),
                    delta_below(n.later, mid, levels - 1, model));
  }
  const double between = n.mid == mid ? 0 : displacement_bound(model, poses_[mid], poses_[n.mid]);
  return (n.delta + between) * (1 + 4 * kUnitRoundoff);
}

double MotionTree::rounding(double reach, double lattice) const {
  const double magnitude = reach + greatest_ * lattice + magnitude_;
  return 256 * kUnitRoundoff * magnitude * (1 + condition_) * (1 + condition_);
}

/// Let s be the least and c the condition of all rotations, and let X bound the coordinates of
/// points and of poses with the model around them, so that |e - p| <= 2 sqrt(3) X. In the exact
/// test a cofactor errs by at most 3 u s1^2, with s1 the greatest singular value, the determinant
/// by 8 u s1^3, and the dot product and the quotient add 5 u: divided by the determinant at most
/// 20 u c^2 |e - p| / s. The stored inverse errs by less than 20 u c^2 / s in norm
/// (docs/design/numerics.md, "Sweep"), and its dot product adds 4 u |e - p| / s. Tilt and rise of a
/// node are computed from the same rows, and the cancellation in rise errs by as much as a dot
/// product of a length that is at most 2 sqrt(3) X, too. The sum of all is below
/// 4 x 24 u c^2 2 sqrt(3) X / s < 350 u c^2 X / s, and 1024 u (1 + c)^2 X / s is more than twice
/// that for any c >= 1.
double MotionTree::height_rounding(double reach) const {
  double least = 1;
  for (const InversePose& pose : inverse_poses_) least = std::min(least, pose.least);
  // Infinite where a rotation may have no inverse, so that nothing is decided by the bound.
  return 1024 * kUnitRoundoff * (reach + magnitude_) * (1 + condition_) * (1 + condition_) / least;
}

std::uint64_t MotionTree::allocated_bytes() const {
  return nodes_.capacity() * sizeof(MotionNode) + inverse_poses_.capacity() * sizeof(InversePose);
}

}  // namespace clearway
