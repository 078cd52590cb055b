#include "core/trajectory/pose_spline.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <string>

#include "clearway/error.hpp"
#include "core/trajectory/eigen_pose.hpp"

namespace clearway {
namespace {

using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

/// A pose's matrix as a rotation times a symmetric stretch, which is negative definite if the pose
/// mirrors.
struct Polar {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Matrix3d stretch;
  bool mirrors;
};

Polar polar_of(const Pose& pose) {
  const Eigen::Matrix3d matrix = Eigen::Map<const RowMajor>(pose.rotation);
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d nearest = svd.matrixU() * svd.matrixV().transpose();
  const Eigen::Matrix3d stretch =
      svd.matrixV() * svd.singularValues().asDiagonal() * svd.matrixV().transpose();
  const double sign = nearest.determinant() < 0 ? -1 : 1;
  return {Eigen::Quaterniond(Eigen::Matrix3d(sign * nearest)).normalized(), sign * stretch,
          sign < 0};
}

Eigen::Vector3d shortened(const Eigen::Vector3d& v, double most) {
  const double length = v.norm();
  return length > most ? Eigen::Vector3d(v * (most / length)) : v;
}

}  // namespace

PoseSpline::PoseSpline(std::span<const Pose> poses, std::span<const double> motions)
    : poses_(poses), spans_(motions.size()), velocities_(poses.size()) {
  std::vector<Leg> legs;
  // The rotation of the pose at which the last leg ended.
  std::size_t known = poses.size();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  for (std::size_t i = 0; i < motions.size(); ++i) {
    if (!(motions[i] > 0)) continue;
    spans_[i] = std::sqrt(motions[i]);
    const Eigen::Quaterniond from = known == i ? rotation : polar_of(poses[i]).rotation;
    known = i + 1;
    rotation = polar_of(poses[known]).rotation;
    const auto turn = from.conjugate() * rotation;
    legs.push_back({i,
                    spans_[i],
                    {(position_of(poses[i + 1]) - position_of(poses[i])) / spans_[i],
                     logarithm(turn) / spans_[i]}});
  }
  std::size_t pose = 0;
  for (std::size_t knot = 0; knot <= legs.size(); ++knot) {
    const Velocity velocity = at_knot(legs, knot);
    const std::size_t end = knot < legs.size() ? legs[knot].from + 1 : poses.size();
    while (pose < end) velocities_[pose++] = velocity;
  }
}

/// The velocity at a knot: that of the parabola through the knot and its neighbours, or at the ends
/// through the next two knots.
PoseSpline::Velocity PoseSpline::at_knot(const std::vector<Leg>& legs, std::size_t knot) const {
  const std::size_t last = legs.size();
  if (last == 0) return {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  if (last == 1) return legs[0].mean;
  if (knot == 0 || knot == last) {
    const Leg& near = legs[knot == 0 ? 0 : last - 1];
    const Leg& far = legs[knot == 0 ? 1 : last - 2];
    const double weight = near.span / (near.span + far.span);
    return limited(weighted(near.mean, 1 + weight, far.mean, -weight), near.mean, near.mean);
  }
  const Leg& before = legs[knot - 1];
  const Leg& after = legs[knot];
  const double weight = before.span / (before.span + after.span);
  return limited(weighted(before.mean, 1 - weight, after.mean, weight), before.mean, after.mean);
}

PoseSpline::Velocity PoseSpline::weighted(const Velocity& a, double weight_a, const Velocity& b,
                                          double weight_b) {
  return {weight_a * a.linear + weight_b * b.linear, weight_a * a.angular + weight_b * b.angular};
}

/// Limits a velocity to three times the slower of its neighbours, so that no step overshoots by
/// more than its own length, and a straight one not at all.
PoseSpline::Velocity PoseSpline::limited(const Velocity& velocity, const Velocity& before,
                                         const Velocity& after) {
  const auto limit = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return 3 * std::min(a.norm(), b.norm());
  };
  return {shortened(velocity.linear, limit(before.linear, after.linear)),
          shortened(velocity.angular, limit(before.angular, after.angular))};
}

PoseCurve PoseSpline::between(std::size_t i) const {
  const Polar from = polar_of(poses_[i]);
  const Polar to = polar_of(poses_[i + 1]);
  if (from.mirrors != to.mirrors) {
    throw InputError("poses " + std::to_string(i) + " and " + std::to_string(i + 1) +
                     " (counting from 0): one mirrors the model, the other does not; nothing leads "
                     "from one to the other");
  }
  const double third = spans_[i] / 3;
  const Velocity& start = velocities_[i];
  const Velocity& end = velocities_[i + 1];
  PoseCurve curve;
  curve.position_ = position_of(poses_[i]);
  curve.rotation_ = from.rotation;
  curve.stretch_ = from.stretch;
  curve.stretch_change_ = to.stretch - from.stretch;
  curve.moves_ = positions(i).moves_;
  curve.turns_[0] = third * start.angular;
  curve.turns_[2] = third * end.angular;
  curve.turns_[1] = logarithm(exponential(curve.turns_[0]).conjugate() * from.rotation.conjugate() *
                              to.rotation * exponential(curve.turns_[2]).conjugate());
  return curve;
}

PositionCurve PoseSpline::positions(std::size_t i) const {
  const double third = spans_[i] / 3;
  PositionCurve curve;
  curve.moves_[0] = third * velocities_[i].linear;
  curve.moves_[2] = third * velocities_[i + 1].linear;
  curve.moves_[1] =
      position_of(poses_[i + 1]) - position_of(poses_[i]) - curve.moves_[0] - curve.moves_[2];
  return curve;
}

Pose PoseCurve::at(double t) const {
  // The cumulative Bernstein polynomials of degree 3.
  const double rest = 1 - t;
  const std::array<double, 3> basis{1 - rest * rest * rest, t * t * (3 - 2 * t), t * t * t};
  Eigen::Vector3d position = position_;
  Eigen::Quaterniond rotation = rotation_;
  for (std::size_t k = 0; k < 3; ++k) {
    position += basis[k] * moves_[k];
    rotation = rotation * exponential(basis[k] * turns_[k]);
  }
  const RowMajor matrix =
      rotation.normalized().toRotationMatrix() * (stretch_ + basis[1] * stretch_change_);
  Pose pose{};
  std::copy(matrix.data(), matrix.data() + 9, pose.rotation);
  std::copy(position.data(), position.data() + 3, pose.translation);
  return pose;
}

}  // namespace clearway
