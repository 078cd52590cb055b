#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "clearway/pose.hpp"
#include "core/geometry/box.hpp"

namespace clearway {

/// An axis of the model's frame, or its opposite.
struct BodyAxis {
  int axis = 0;  ///< 0 x, 1 y, 2 z
  bool negative = false;
  double cosine = 0;  ///< mean of the cosines between it and what it is compared with; 0: none
};

/// What poses have in common. Steps are those of the positions, the model's size does not count.
struct TrajectorySummary {
  std::size_t poses = 0;
  Box box{};               ///< of the positions; of no poses: zeros
  double length = 0;       ///< of the path
  double median_step = 0;  ///< of the steps that move
  double largest_step = 0;
  std::size_t largest_step_pose = 0;  ///< from which it starts
  std::size_t still_steps = 0;        ///< that move no position
  double total_turn = 0;              ///< radians, all turns between neighbours
  double largest_turn = 0;            ///< radians
  std::size_t largest_turn_pose = 0;  ///< from which it starts
  double skew = 0;                    ///< the greatest entry of |R^T R - I|
  BodyAxis up;                        ///< that points most along the world's z, over all poses
  BodyAxis forward;                   ///< that points most along the motion, by length of way
};

TrajectorySummary summarize_trajectory(std::span<const Pose> poses);

/// The angle of the rotation from a to b, radians.
double turn_between(const Pose& a, const Pose& b);

/// A piece of the way, straight from a pose to a later one.
struct Chord {
  Vec3 direction;  ///< unit
  double length = 0;
  std::size_t middle;  ///< the pose halfway between
};

/// Pieces of at least `least` metres, one after the other.
std::vector<Chord> chords_of(std::span<const Pose> poses, double least);

}  // namespace clearway
