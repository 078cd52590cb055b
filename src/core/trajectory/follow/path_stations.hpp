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

/// The stations of a path: metres of arc length in space from the first pose, in the order of the
/// poses, along the PoseSpline of the positions. Two consecutive poses at one position are at one
/// station. docs/design/bodies.md.
class PathStations {
 public:
  /// A place of the curve: parameter t of the way from pose `way` to the next one.
  struct Place {
    std::size_t way;
    double t;  ///< from 0 to 1; 0 at the last pose
  };

  /// poses: must outlive this object. Throws InputError if positions are too far apart for a finite
  /// distance, or if one pose mirrors the model and the next does not.
  PathStations(std::span<const Pose> poses, int threads);
  ~PathStations();
  PathStations(PathStations&&) noexcept;

  std::span<const Pose> poses() const { return poses_; }
  /// Length of the whole path, metres.
  double length() const { return of_pose_.empty() ? 0 : of_pose_.back(); }
  /// Station of pose i, metres.
  double of_pose(std::size_t i) const { return of_pose_[i]; }
  /// Length of the way from pose i to the next one, metres.
  double way_length(std::size_t i) const { return lengths_[i]; }
  /// The place `metres` after pose `way`, on the way from that pose to the next one.
  Place on_way(std::size_t way, double metres) const;
  /// The place at a station. None if it is off the path by more than a nanometre, which is
  /// rounding. Where the path stands still at the station, it is the last of its poses there.
  std::optional<Place> at_station(double station) const;

  /// The place `ahead` metres ahead of pose i (negative: behind), as at_station() finds it, or
  /// none. For 0 it is the pose itself.
  std::optional<Place> ahead_of(std::size_t i, double ahead) const;

  /// The pose at a place. If the place is a pose, that pose to the last bit.
  Pose pose_at(const Place& place) const;
  /// The position of pose_at(), without its rotation; up to rounding.
  Vec3 position_at(const Place& place) const;
  /// The direction of the path in the order of the poses; its length is 0 only if the whole path is
  /// at one place.
  Vec3 direction_at(const Place& place) const;

 private:
  std::span<const Pose> poses_;
  std::unique_ptr<const PoseSpline> spline_;
  std::vector<double> lengths_;  ///< lengths of the ways
  std::vector<double> of_pose_;
};

}  // namespace clearway
