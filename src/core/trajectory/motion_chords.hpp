#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/box.hpp"
#include "core/trajectory/motion_tree.hpp"

namespace clearway {

/// How straight the poses of every node of a motion tree move, seen from the model.
class MotionChords {
 public:
  /// For points that are at most `reach` metres from the model, the rounding of a test included.
  /// spacing: of the model's points, metres. Nodes whose chord is of no use beside it have none.
  MotionChords(const MotionTree& motion, const Box& model, double reach, double spacing,
               int threads);
  MotionChords() = default;

  /// A node, in the order of the tree.
  const MotionChord* data() const { return chords_.data(); }

  std::uint64_t allocated_bytes() const { return chords_.capacity() * sizeof(MotionChord); }

 private:
  std::vector<MotionChord> chords_;
};

}  // namespace clearway
