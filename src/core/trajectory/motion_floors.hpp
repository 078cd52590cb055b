#pragma once

#include <cstdint>
#include <vector>

#include "core/trajectory/motion_tree.hpp"

namespace clearway {

/// How level the poses of every node of a motion tree are, for queries with a floor.
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
