#pragma once

#include <cstdint>
#include <span>

#include "clearway/query.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "core/geometry/box.hpp"
#include "core/geometry/sweep_bounds.hpp"
#include "core/trajectory/chainage.hpp"
#include "io/formats/point_reader.hpp"

namespace clearway {

/// The query, the environment and derived sizes that the checks of a query look at. Owns nothing.
struct Question {
  /// The environment and the model have at least one point, and the trajectory at least one pose.
  Question(const PackedCloud& environment, LengthUnit length_unit, const Query& asked);
  /// The question about a body. path_pose: the one of Body. path_chainage: chainage of all poses of
  /// the path that the body follows.
  Question(const PackedCloud& environment, LengthUnit length_unit, const Query& asked,
           std::span<const std::uint32_t> path_pose, std::span<const double> path_chainage);

  /// The number by which users know a pose.
  std::uint32_t number_of(std::uint32_t pose) const {
    return path_pose.empty() ? pose : path_pose[pose];
  }
  /// Metres along the positions of the path up to the pose that users know as number_of(pose).
  double chainage(std::uint32_t pose) const;

  const PackedCloud& cloud;
  LengthUnit unit;
  const Query& query;
  std::span<const std::uint32_t> path_pose;
  /// Chainage of the path's poses for a body; empty otherwise, since it then follows from the
  /// poses.
  std::span<const double> path_chainage;
  /// The box around all points.
  Box environment;
  /// The model's box in its own frame.
  Box model;
  /// The length of a metre in the environment's unit.
  double metre;
};

/// The lengths of a box's sides, the longest first.
struct Sides {
  explicit Sides(const Box& box);
  double longest, middle, shortest;
};

/// The factor by which a pose stretches lengths, on average over the axes; 1 for a rigid one.
double scale_of(const Pose& pose);

}  // namespace clearway
