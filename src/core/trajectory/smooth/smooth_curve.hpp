#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <span>
#include <vector>

#include "clearway/pose.hpp"

namespace clearway {

/// Poses with the parameter of a curve at which each stands.
struct ParameterisedPath {
  std::vector<double> at = {};  ///< ascending from 0
  std::vector<Eigen::Vector3d> positions = {};
  /// Unit quaternions, each on the side of the one before it; empty where no rotation changes.
  std::vector<Eigen::Quaterniond> rotations = {};

  double length() const { return at.back(); }
};

/// A cubic B-spline with uniform knots over [0, length]: positions by its control points, rotations
/// by the cumulative form of Kim, Kim and Shin, in which each control rotation counts by its
/// logarithm relative to the one before it (docs/design/trajectory.md, "Smoothing").
class SmoothCurve {
 public:
  /// The least-squares fit of `spans` spans to a path and to the chords between its poses, each
  /// part weighted by its share of the parameter. Takes time linear in poses and spans. fixed: the
  /// rotation of all poses where the path has no rotations, 3 x 3.
  SmoothCurve(const ParameterisedPath& path, std::size_t spans, std::span<const double, 9> fixed);

  Pose at(double parameter) const;
  double spacing() const { return spacing_; }  ///< from knot to knot
  std::size_t spans() const { return control_.size() - 3; }
  std::size_t control_points() const { return control_.size(); }

  /// An upper bound on the length of the second derivative by the parameter of a model point that
  /// is at most `reach` from the model's origin, over [from, to], which holds no knot inside.
  double second_derivative_bound(double from, double to, double reach) const;

 private:
  struct Place {
    std::size_t span;
    double t;  ///< 0 <= t <= 1 within the span
  };
  Place place_of(double parameter) const;
  Eigen::Quaterniond rotation_at(const Place& place) const;
  void find_turns();
  void fit(const ParameterisedPath& path);

  double spacing_;
  Eigen::Vector3d origin_;                    ///< control points are relative to it
  std::vector<Eigen::Vector3d> control_;      ///< metres
  std::vector<Eigen::Quaterniond> rotation_;  ///< control rotations, or empty
  std::vector<Eigen::Vector3d> turn_;         ///< logarithm from the control rotation before
  double fixed_[9];
};

}  // namespace clearway
