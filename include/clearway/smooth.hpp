#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "clearway/box.hpp"
#include "clearway/pose.hpp"
#include "clearway/progress.hpp"

/// Smoothing of recorded paths by B-splines.
namespace clearway {

/// How a path is smoothed. Lengths are in the unit of its poses.
struct SmoothParameters {
  /// No model point is farther than this from where the given path has it, along the whole path.
  double within = 0;
  /// No model point moves more than this from one pose of the new path to the next; 0: 0.1
  double step = 0;
};

/// A path on a smooth curve, and how far it is from the given one. Distances are those of any point
/// of the model's box or, without a model, of the positions. They are upper bounds, rounding
/// included, between poses as well, where both paths move each model point on a straight line.
struct SmoothPath {
  std::vector<Pose> poses = {};
  /// For each pose the place of the given path that it stands for: 3.25 is a quarter of the way
  /// from pose 3 to pose 4.
  std::vector<double> place = {};
  std::size_t control_points = 0;  ///< of the curve
  double largest_deviation = 0;    ///< along the whole path
  double mean_deviation = 0;       ///< of the given poses
  double largest_step = 0;         ///< from one new pose to the next

  /// What --error-model has to be, so that a search of the new path between its poses covers the
  /// given path: whatever comes closer than a radius to the given path comes closer than the radius
  /// and this to the new one.
  double error_between_poses() const { return largest_deviation; }
  /// The same for a search at the new poses alone.
  double error_at_poses() const { return largest_deviation + largest_step / 2; }
};

/// Puts a cubic B-spline to a path by least squares, and poses on it. The number of its control
/// points is doubled until it stays within the distance, and then bisected. model: the box of the
/// model; required where rotations change. Throws UsageError for lengths that are not above 0,
/// without a model that is required, and where no curve of eight control points for each pose,
/// 65,536 at least and a million at most, stays within the distance; InputError for a path without
/// poses, with a jump, or that scales or mirrors; Interrupted. docs/design/trajectory.md has the
/// definitions.
SmoothPath smooth_trajectory(std::span<const Pose> poses, const SmoothParameters& parameters,
                             const std::optional<Box>& model = {},
                             const ProgressCallback& progress = nullptr, StopFlag stop = nullptr);

}  // namespace clearway
