#pragma once

#include <cstdint>
#include <vector>

#include "core/trajectory/motion_tree.hpp"

namespace clearway {

/// How level the poses of every node of a motion tree are, for queries with a floor. With a, the
/// third row of the inverse rotation, and the position p of a pose, the height of e in the body's
/// frame is a . (e - p), hence
///   z_i(e) - z_mid(e) = (a_i - a_mid) . (e - p_mid) + a_i . (p_mid - p_i),
/// which is at most tilt |e - p_mid| + rise. Neither grows with the way that the vehicle travels on
/// level ground.
class MotionFloors {
 public:
  MotionFloors() = default;
  /// All rotations have an inverse.
  MotionFloors(const MotionTree& motion, int threads);

  /// One for each node, in the order of the tree.
  const MotionFloor* data() const { return floors_.data(); }
  std::uint64_t allocated_bytes() const { return floors_.capacity() * sizeof(MotionFloor); }

 private:
  std::vector<MotionFloor> floors_;
};

}  // namespace clearway
