#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "clearway/pose.hpp"
#include "clearway/vec3.hpp"

namespace clearway {

class PoseSpline;

/// A path by its stations: metres of arc length in space from the first pose, in the order of the
/// poses, along the PoseSpline of the positions. Two poses at one position are at one station.
/// docs/design/bodies.md.
class PathStations {
 public:
  /// A place of the curve: parameter t of the way from pose `way` to the next one.
  struct Place {
    std::size_t way;
    double t;  ///< 0 <= t <= 1, and 0 at the last pose
  };

  /// `poses` outlive it. Throws InputError where positions are too far apart for a number, and
  /// where one pose mirrors the model and the next does not.
  PathStations(std::span<const Pose> poses, int threads);
  ~PathStations();
  PathStations(PathStations&&) noexcept;

  std::span<const Pose> poses() const { return poses_; }
  /// Of the whole path, metres.
  double length() const { return of_pose_.empty() ? 0 : of_pose_.back(); }
  /// Of a pose, metres.
  double of_pose(std::size_t i) const { return of_pose_[i]; }

  /// The place `ahead` metres (negative: behind) of pose i. None where that is off the path by more
  /// than a nanometre, which is rounding. At 0 it is the pose itself. Where the path stands still
  /// at the station, the last of its poses there.
  std::optional<Place> ahead_of(std::size_t i, double ahead) const;

  /// At a place that is a pose, that pose to the last bit.
  Pose pose_at(const Place& place) const;
  /// In the order of the poses; of length 0 only where the whole path is at one place.
  Vec3 direction_at(const Place& place) const;

 private:
  std::span<const Pose> poses_;
  std::unique_ptr<const PoseSpline> spline_;
  std::vector<double> lengths_;  ///< of the ways
  std::vector<double> of_pose_;
};

}  // namespace clearway
