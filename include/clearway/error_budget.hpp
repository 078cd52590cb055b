#pragma once

#include <cmath>

namespace clearway {

/// By how much the true distance between the model and a scanned place may differ from the one that
/// was computed. Lengths are in the environment's unit; all but the angle are 0 or more.
struct ErrorBudget {
  // What the user gives: standard deviations per axis, except for the hard bound of the model.
  double scan = 0, registration = 0, pose = 0;
  double angle = 0;   ///< radians
  double model = 0;   ///< no place of the true vehicle is farther than this from its model
  double sigmas = 3;  ///< how many standard deviations count

  // What follows from the query and the environment.
  double step = 0;   ///< half the diagonal of the step to which coordinates were rounded
  double lever = 0;  ///< the greatest distance of a model point from the origin of its frame
  /// Half the greatest motion of the model from one pose to the next; 0 between poses, where all of
  /// the way is searched
  double motion = 0;
  double chord = 0;    ///< the greatest deviation of the true motion from the straight way
  double spacing = 0;  ///< no place of a mesh searched as points is farther than this from a point

  /// How many standard deviations of the scan count against a conflict, because the least of
  /// thousands of noisy points is always closer than the true surface.
  static constexpr double kScanSigmas = 6;

  double hard() const { return model + step; }
  double way() const { return motion + chord + spacing; }
  /// U_clear: nothing closer than the margin plus this means that the vehicle is clear.
  double clear() const {
    const double turned = angle * lever;
    return hard() + way() +
           sigmas *
               std::sqrt(scan * scan + registration * registration + pose * pose + turned * turned);
  }
  /// U_conflict: a point closer than the margin less this is certainly too close.
  double conflict() const {
    const double turned = angle * lever;
    return hard() +
           sigmas * std::sqrt(registration * registration + pose * pose + turned * turned) +
           kScanSigmas * scan;
  }
  /// The radius that has to be free of points for a clear passage at margin `radius`.
  double near_radius(double radius) const { return radius + clear(); }
  /// A point closer than this is certainly too close at margin `radius`. Below 0 only points that
  /// are as deep inside a solid are.
  double certain_radius(double radius) const { return radius - conflict(); }

  friend bool operator==(const ErrorBudget&, const ErrorBudget&) = default;
};

}  // namespace clearway
