#pragma once

#include <cstdint>
#include <limits>
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
  /// By need: at() finds the curve of a node when it is first asked for. The tree outlives it.
  MotionCurves(const MotionTree& motion, const Box& model, double reach, double spacing);
  MotionCurves() = default;

  /// A node, in the order of the tree; not for curves by need.
  const MotionCurve* data() const { return curves_.data(); }

  /// The curve of a node. Thread safe.
  MotionCurve at(std::uint32_t node) const;

  std::uint64_t allocated_bytes() const { return curves_.capacity() * sizeof(MotionCurve); }

 private:
  /// The error of a curve that nobody asked for yet: neither one place nor smooth.
  static constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

  float error_of(const MotionNode& node, double least) const;

  const MotionTree* motion_ = nullptr;
  Box model_{};
  double reach_ = 0, spacing_ = 0;
  mutable std::vector<MotionCurve> curves_;
};

}  // namespace clearway
