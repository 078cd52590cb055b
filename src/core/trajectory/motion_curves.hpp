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
  /// Computes all curves at once. reach: greatest distance of points from the model, metres,
  /// including the rounding of a test. spacing: that of the model's points, metres; nodes whose
  /// curve is of no use for it have none.
  MotionCurves(const MotionTree& motion, const Box& model, double reach, double spacing,
               int threads);
  /// Computes curves by need: at() finds the curve of a node when it is first asked for. The tree
  /// must outlive this object.
  MotionCurves(const MotionTree& motion, const Box& model, double reach, double spacing);
  MotionCurves() = default;

  /// One curve for each node, in the order of the tree; not for curves by need.
  const MotionCurve* data() const { return curves_.data(); }

  /// The curve of a node. Thread safe.
  MotionCurve at(std::uint32_t node) const;

  std::uint64_t allocated_bytes() const { return curves_.capacity() * sizeof(MotionCurve); }

 private:
  /// The error of a curve that was not asked for yet; it makes the curve neither one place nor
  /// smooth.
  static constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

  float error_of(const MotionNode& node, double least) const;

  const MotionTree* motion_ = nullptr;
  Box model_{};
  double reach_ = 0, spacing_ = 0;
  mutable std::vector<MotionCurve> curves_;
};

}  // namespace clearway
