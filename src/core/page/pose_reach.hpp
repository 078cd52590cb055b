#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/box.hpp"
#include "core/trajectory/motion_tree.hpp"

namespace clearway {

/// The one interface by which the plan knows an engine: which poses may bring the model within
/// reach of a box.
class PoseReach {
 public:
  virtual ~PoseReach() = default;

  virtual const MotionTree& motion() const = 0;

  /// Replaces `out` with those of `nodes` of the motion tree, and the nodes below them, that may
  /// matter to a point of the box; they are as fine as the box is small, and in the order of the
  /// poses if `nodes` are. Thread safe.
  virtual void narrow(const Box& box, std::span<const std::uint32_t> nodes,
                      std::vector<std::uint32_t>& out) const = 0;
};

}  // namespace clearway
