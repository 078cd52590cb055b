#pragma once

#include <cstdint>
#include <span>

#include "clearway/query.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "core/geometry/box.hpp"
#include "core/geometry/sweep_bounds.hpp"
#include "io/formats/point_reader.hpp"

namespace clearway {

/// What the checks of a query look at. Owns nothing.
struct Question {
  /// The environment has a point, the model too, the trajectory a pose.
  Question(const PackedCloud& environment, LengthUnit length_unit, const Query& asked);
  /// Of a body: path_pose as Body has it, chainage of all poses of the path that it follows.
  Question(const PackedCloud& environment, LengthUnit length_unit, const Query& asked,
           std::span<const std::uint32_t> path_pose, std::span<const double> path_chainage);

  /// What users know a pose as.
  std::uint32_t number_of(std::uint32_t pose) const {
    return path_pose.empty() ? pose : path_pose[pose];
  }
  /// Metres along the positions of the path, up to what users know a pose as.
  double chainage(std::uint32_t pose) const;

  const PackedCloud& cloud;
  LengthUnit unit;
  const Query& query;
  std::span<const std::uint32_t> path_pose;
  std::span<const double> path_chainage;  ///< of a body; else it follows from the poses
  Box environment;                        ///< of all points
  Box model;                              ///< in its own frame
  double metre;                           ///< in the environment's unit
};

/// The lengths of a box's sides, the longest first.
struct Sides {
  explicit Sides(const Box& box);
  double longest, middle, shortest;
};

/// By how much a pose stretches lengths, on average over the axes; 1 for a rigid one.
double scale_of(const Pose& pose);

/// From pose to pose.
double path_length(const std::vector<Pose>& poses);

}  // namespace clearway
