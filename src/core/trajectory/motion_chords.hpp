#pragma once

#include <vector>

#include "core/geometry/box.hpp"
#include "core/trajectory/motion_tree.hpp"

namespace clearway {

/// How straight the poses of every node of a motion tree move, seen from the model.
class MotionChords {
 public:
  /// For points that are at most `reach` from the model, after its poses' rounding. Nodes whose
  /// error would exceed `most_error` metres have none.
  MotionChords(const MotionTree& motion, const Box& model, double reach, double most_error);
  MotionChords() = default;

  /// A node, in the order of the tree.
  const MotionChord* data() const { return chords_.data(); }

 private:
  std::vector<MotionChord> chords_;
};

}  // namespace clearway
