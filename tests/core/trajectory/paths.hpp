#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "support/attitudes.hpp"
#include "support/scenes.hpp"

/// Paths and parts of poses for the tests of trajectories.
namespace clearway::test {

/// A pose that is turned about z.
inline Pose headed(double heading, const Vec3& at) { return rotation({0, 0, 1}, heading, at); }

inline Pose turned_at(const Rotation& rotation, const Vec3& at) {
  Pose pose = translation(at);
  std::ranges::copy(rotation, pose.rotation);
  return pose;
}

/// A pose every `step` metres along x.
inline std::vector<Pose> straight_poses(std::size_t count, double step = 1) {
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < count; ++i) {
    poses.push_back(translation({step * static_cast<double>(i), 0, 0}));
  }
  return poses;
}

/// A pose every `step` metres along a circle of curvature k, which begins at the origin along x.
inline std::vector<Pose> circle_poses(double k, double step, std::size_t count) {
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < count; ++i) {
    const double a = k * step * static_cast<double>(i);
    poses.push_back(headed(a, {std::sin(a) / k, (1 - std::cos(a)) / k, 0}));
  }
  return poses;
}

/// Poses in steps from a millimetre to ten metres, turned about any axis by up to `turn`.
inline std::vector<Pose> random_walk(Random& random, std::size_t count, double far, double turn) {
  std::vector<Pose> poses;
  Vec3 at{far, -far, far / 10};
  for (std::size_t i = 0; i < count; ++i) {
    const double step = std::pow(10, uniform(random, -3, 1));
    at = at + step * random_direction(random);
    poses.push_back(rotation(random_direction(random), uniform(random, 0, turn), at));
  }
  return poses;
}

inline Vec3 axis_of(const Pose& pose, int axis) {
  return {pose.rotation[axis], pose.rotation[3 + axis], pose.rotation[6 + axis]};
}

inline double distance(const Vec3& a, const Vec3& b) { return length(a - b); }
inline double distance(const Pose& a, const Pose& b) {
  return distance(a.position(), b.position());
}

}  // namespace clearway::test
