#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/box.hpp"
#include "core/trajectory/motion_tree.hpp"

namespace clearway {

/// How smoothly the poses of every node of a motion tree move, seen from the model.
class MotionCurves {
 public:
  /// For points that are at most `reach` metres from the model, the rounding of a test included.
  /// spacing: of the model's points, metres. Nodes whose curve is of no use beside it have none.
  MotionCurves(const MotionTree& motion, const Box& model, double reach, double spacing,
               int threads);
  MotionCurves() = default;

  /// A node, in the order of the tree.
  const MotionCurve* data() const { return curves_.data(); }

  std::uint64_t allocated_bytes() const { return curves_.capacity() * sizeof(MotionCurve); }

 private:
  std::vector<MotionCurve> curves_;
};

}  // namespace clearway
