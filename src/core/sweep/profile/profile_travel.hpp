#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/box.hpp"
#include "core/geometry/sweep_bounds.hpp"
#include "core/trajectory/motion_tree_ref.hpp"

namespace clearway {

/// How far a model has moved up to each pose, for bounds that last: what is proven at one pose
/// holds at a later one, less the motion between them (docs/design/numerics.md, "Profile").
class ProfileTravel {
 public:
  ProfileTravel() = default;
  /// model: a box around every model point. has_floor: whether sleep() will be called; all
  /// rotations then have an inverse.
  ProfileTravel(const MotionTreeRef& motion, const Box& model, bool has_floor, int threads);

  /// Metres; between two poses it grows by at least the distance that any model point moves.
  double moved(std::uint32_t pose) const { return moved_[pose]; }

  /// The first pose after `pose` and before `end` at which the height of a place in the body's
  /// frame may be greater by `gap` than at `pose`, or `end`. farthest: the place is never farther
  /// than this from the position of a pose.
  std::uint32_t sleep(std::uint32_t pose, std::uint32_t end, double farthest, double gap) const;

  std::uint64_t allocated_bytes() const {
    return (moved_.capacity() + turned_.capacity() + risen_.capacity()) * sizeof(double);
  }

 private:
  double height_change(std::uint32_t pose, double farthest) const {
    return farthest * turned_[pose] + risen_[pose];
  }

  std::vector<double> moved_;
  /// Sums over the steps up to each pose, only with a floor: how much the third row of the inverse
  /// rotation changes, and how far the position of the pose before lies above or below
  std::vector<double> turned_, risen_;
};

}  // namespace clearway
