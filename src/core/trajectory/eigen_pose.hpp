#pragma once

#include <Eigen/Geometry>
#include <cmath>

#include "clearway/pose.hpp"

namespace clearway {

inline Eigen::Vector3d position_of(const Pose& pose) {
  return Eigen::Map<const Eigen::Vector3d>(pose.translation);
}

/// The rotation by a rotation vector, in radians.
inline Eigen::Quaterniond exponential(const Eigen::Vector3d& turn) {
  const double half = turn.norm() / 2;
  const double factor = half > 0 ? std::sin(half) / (2 * half) : 0.5;
  Eigen::Quaterniond q;
  q.w() = std::cos(half);
  q.vec() = factor * turn;
  return q;
}

/// The rotation vector of a quaternion, of length at most pi.
inline Eigen::Vector3d logarithm(const Eigen::Quaterniond& q) {
  const double sine = q.vec().norm();
  const double sign = q.w() < 0 ? -1 : 1;
  return sign * (sine > 0 ? 2 * std::atan2(sine, sign * q.w()) / sine : 2) * q.vec();
}

}  // namespace clearway
