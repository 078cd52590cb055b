#pragma once

#include <cstdint>
#include <vector>

#include "clearway/box.hpp"
#include "clearway/conflicts.hpp"
#include "clearway/pose.hpp"
#include "clearway/vec3.hpp"

namespace clearway {

/// The unit vector to the left in the model's frame.
Vec3 direction_to_left(Axis forward, Axis up);

/// The model's forward axis at a pose; about of unit length, as the pose's rotation is.
Vec3 direction_ahead(const Pose& pose, Axis forward);

/// The vector from the position of a pose to a place, along the model's axes: ahead, to the left,
/// up.
Vec3 ahead_left_up(const Vec3& place, const Pose& pose, Axis forward, Axis up);

/// On which side of the model's box another box lies. seen: the other box, along the axes of
/// ahead_left_up(). The side is left, right, above or below where the whole box lies beyond that
/// side, namely the side that it is farthest beyond. Otherwise the box is in the way: in front or
/// behind where all of it lies ahead or behind. For a box that reaches into the model's, it is the
/// side on which it would be outside soonest. Among equal sides, the first of left, right, above,
/// below, front, behind.
Side side_of(const Box& seen, const Box& model, Axis forward, Axis up);

/// A box of the model's frame, along the axes of ahead_left_up().
Box turned(const Box& box, Axis forward, Axis up);

/// The path cut into stretches at multiples of a length.
class PathStretches {
 public:
  /// split: the length, above 0, or 0 for one single stretch.
  PathStretches(const std::vector<double>& chainage, double split);

  /// The number of the stretch that a pose is in. Stretches that have a pose are numbered
  /// consecutively from 0.
  std::uint32_t operator[](std::uint32_t pose) const { return number_.empty() ? 0 : number_[pose]; }

 private:
  /// The stretch of each pose; empty where there is only one.
  std::vector<std::uint32_t> number_;
};

/// The axes along which a model is seen.
struct AheadLeftUp {
  Axis forward, up;
};

}  // namespace clearway
