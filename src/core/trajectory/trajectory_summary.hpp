#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "clearway/pose.hpp"
#include "core/geometry/box.hpp"

namespace clearway {

/// displacement_bound() in metres, but 0 for equal poses, whose model points coincide exactly.
double motion_bound(const Box& model, const Pose& a, const Pose& b);

/// The greatest motion_bound() of two consecutive poses, metres; 0 for fewer than two poses.
double largest_motion(const Box& model, std::span<const Pose> poses);

/// An axis of the model's frame, or its opposite.
struct BodyAxis {
  int axis = 0;  ///< 0 for x, 1 for y, 2 for z
  bool negative = false;
  double cosine = 0;  ///< mean cosine between the axis and what it is compared with; 0: none
};

/// Summary of a trajectory. Steps are those of the positions, whatever the model's size.
struct TrajectorySummary {
  std::size_t poses = 0;
  Box box{};               ///< box around the positions; zeros if there are no poses
  double length = 0;       ///< length of the path
  double median_step = 0;  ///< median of the steps that are longer than 0
  double largest_step = 0;
  std::size_t largest_step_pose = 0;  ///< pose from which the largest step starts
  std::size_t still_steps = 0;        ///< number of steps of length 0
  double total_turn = 0;              ///< sum of the turns between neighbours, radians
  double largest_turn = 0;            ///< greatest turn between neighbours, radians
  std::size_t largest_turn_pose = 0;  ///< pose from which the largest turn starts
  double skew = 0;                    ///< greatest entry of |R^T R - I| over all poses
  BodyAxis up;                        ///< axis that points most along the world's z, over all poses
  BodyAxis forward;  ///< axis that points most along the motion, weighted by length
};

/// The box around the positions of poses, of which there is at least one.
Box box_of_positions(std::span<const Pose> poses);

TrajectorySummary summarize_trajectory(std::span<const Pose> poses);

/// The angle of the rotation from a to b, radians.
double turn_between(const Pose& a, const Pose& b);

/// A piece of the path, as a straight line from one pose to a later one.
struct Chord {
  Vec3 direction;  ///< unit vector
  double length = 0;
  std::size_t middle;  ///< the pose halfway between the two
};

/// The path as consecutive chords of at least `least` metres.
std::vector<Chord> chords_of(std::span<const Pose> poses, double least);

}  // namespace clearway
