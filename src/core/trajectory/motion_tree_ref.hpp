#pragma once

#include <cstdint>
#include <limits>

#include "clearway/pose.hpp"
#include "clearway/vec3.hpp"

namespace clearway {

/// A range of consecutive poses around one of them. Preorder: the earlier half is the next node,
/// and the nodes of a range of n poses are the 2 n - 1 from its own on.
struct MotionNode {
  std::uint32_t first;
  std::uint32_t count;
  std::uint32_t mid;    ///< a pose of the range
  std::uint32_t later;  ///< node of the later half, 0 where count is 1
  /// No model point is farther at any pose of the range from where it is at mid; between poses, nor
  /// at the pose after the range, so nowhere on its segments either.
  double delta;
};

/// The true inverse of a pose's rotation, never its transpose: poses read from text are not quite
/// rigid.
struct InversePose {
  double inverse[9];      ///< row-major
  double translation[3];  ///< of the pose itself
  double least;     ///< at most the least singular value of the rotation; 0 where none is proven
  double greatest;  ///< at least the greatest

  /// x with transform(pose, x) = e, up to the rounding that docs/design/numerics.md ("Sweep")
  /// bounds.
  CLEARWAY_HD Vec3 apply(const Vec3& e) const {
    const double x = e.x - translation[0], y = e.y - translation[1], z = e.z - translation[2];
    return {inverse[0] * x + inverse[1] * y + inverse[2] * z,
            inverse[3] * x + inverse[4] * y + inverse[5] * z,
            inverse[6] * x + inverse[7] * y + inverse[8] * z};
  }
};

/// How straight a node's poses move, seen from the model: what they pull back to lies near the
/// chord between what its first and its last pose do.
struct MotionChord {
  static constexpr float kEqual = -1;  ///< error: all poses are equal
  static constexpr float kNone = std::numeric_limits<float>::infinity();

  float error;  ///< metres, of places that matter
  float least;  ///< at most the least singular value of any rotation

  CLEARWAY_HD bool is_one_place() const { return error < 0; }
  CLEARWAY_HD bool is_straight() const { return error < kNone; }
};

/// A MotionTree where it lies, on the host or on a device. Does not own it.
struct MotionTreeRef {
  const MotionNode* nodes;           ///< 2 pose_count - 1, or none
  const InversePose* inverse_poses;  ///< a pose
  const Pose* poses;
  std::uint32_t pose_count;
  const MotionChord* chords = nullptr;  ///< a node, or null where none are needed

  /// Replaces both halves of a straight node by it, again and again; nodes in the order of the
  /// poses. How many are left.
  CLEARWAY_HD std::uint32_t join_straight(std::uint32_t* list, std::uint32_t count) const {
    std::uint32_t left = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      list[left++] = list[i];
      while (left > 1 && is_straight_from(list[left - 2], list[left - 1])) --list[--left - 1];
    }
    return left;
  }

 private:
  /// Whether the halves are those of a straight node, which is then earlier - 1.
  CLEARWAY_HD bool is_straight_from(std::uint32_t earlier, std::uint32_t later) const {
    return earlier > 0 && nodes[earlier - 1].later == later && chords[earlier - 1].is_straight();
  }
};

}  // namespace clearway
