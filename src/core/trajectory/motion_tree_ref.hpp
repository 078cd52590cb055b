#pragma once

#include <cstdint>
#include <limits>

#include "clearway/box.hpp"
#include "clearway/pose.hpp"
#include "clearway/vec3.hpp"

namespace clearway {

/// A range of consecutive poses around one of them. Nodes are in preorder: the earlier half is the
/// next node, and the subtree of a range of n poses is the 2 n - 1 nodes from its own on.
struct MotionNode {
  std::uint32_t first;
  std::uint32_t count;
  std::uint32_t mid;    ///< the middle pose, which is one of the range
  std::uint32_t later;  ///< node of the later half, 0 if count is 1
  /// Metres: no model point is farther than this, at any pose of the range, from where it is at
  /// mid. Between poses that includes the pose after the range, and so the segments up to it.
  double delta;
};

/// A pose for pulling points back. It holds the true inverse of the rotation, never its transpose,
/// because poses read from text are not quite rigid.
struct InversePose {
  double inverse[9];      ///< row-major
  double translation[3];  ///< translation of the pose itself
  double least;     ///< lower bound on the rotation's least singular value; 0 if none is proven
  double greatest;  ///< upper bound on the rotation's greatest singular value

  /// Pulls e back: returns x with transform(pose, x) = e, up to the rounding that
  /// docs/design/numerics.md ("Sweep") bounds.
  CLEARWAY_HD Vec3 apply(const Vec3& e) const {
    const double x = e.x - translation[0], y = e.y - translation[1], z = e.z - translation[2];
    return {inverse[0] * x + inverse[1] * y + inverse[2] * z,
            inverse[3] * x + inverse[4] * y + inverse[5] * z,
            inverse[6] * x + inverse[7] * y + inverse[8] * z};
  }
};

/// How smoothly a node's poses move as seen from the model: a point pulled back by pose i of n lies
/// near place i / (n - 1) of the MotionParabola.
struct MotionCurve {
  static constexpr float kEqual = -1;  ///< value of `error`: all poses are equal
  static constexpr float kNone = std::numeric_limits<float>::infinity();

  float error;  ///< metres; bound on the distance from the parabola, for points that matter
  float least;  ///< lower bound on the least singular value of any rotation

  CLEARWAY_HD bool is_one_place() const { return error < 0; }
  CLEARWAY_HD bool is_smooth() const { return error < kNone; }
};

/// How far the height of a place in the body's frame may change over the poses of a node: by at
/// most tilt times the place's distance from the middle pose's position, plus rise
/// (docs/design/sweep.md). Between poses that includes the pose after the range.
struct MotionFloor {
  double tilt = 0;  ///< change of the third row of the inverse rotation
  double rise = 0;  ///< metres
};

/// A parabola through a point pulled back by the first, a middle and the last pose of a node, at
/// the places 0, `middle_place` and 1.
struct MotionParabola {
  std::uint32_t first, middle, last;
  double middle_place;

  CLEARWAY_HD explicit MotionParabola(const MotionNode& node)
      : first(node.first),
        middle(node.first + (node.count - 1) / 2),
        last(node.first + node.count - 1),
        middle_place(static_cast<double>(middle - first) /
                     (node.count > 1 ? static_cast<double>(node.count - 1) : 1.0)) {}

  /// The value of t (1 - t) at the middle pose; 0 if there is none.
  CLEARWAY_HD double height() const { return middle_place * (1 - middle_place); }

  /// The bend of start + t way + t (1 - t) bend, so that it passes through `at_middle` at the
  /// middle.
  CLEARWAY_HD Vec3 bend(const Vec3& start, const Vec3& way, const Vec3& at_middle) const {
    const double top = height();
    Vec3 out{};
    for (int k = 0; k < 3 && top > 0; ++k) {
      out[k] = (at_middle[k] - start[k] - middle_place * way[k]) / top;
    }
    return out;
  }

  /// A box around the curve start + t way + t (1 - t) bend.
  CLEARWAY_HD static Box box(const Vec3& start, const Vec3& way, const Vec3& bend) {
    Box box{start, start};
    for (int k = 0; k < 3; ++k) {
      (way[k] < 0 ? box.lo : box.hi)[k] += way[k];
      (bend[k] < 0 ? box.lo : box.hi)[k] += 0.25 * bend[k];
    }
    return box;
  }
};

/// View of a MotionTree on the host or on a device. Does not own it.
struct MotionTreeRef {
  const MotionNode* nodes;           ///< 2 pose_count - 1 nodes, or none
  const InversePose* inverse_poses;  ///< one for each pose
  const Pose* poses;
  std::uint32_t pose_count;
  const MotionCurve* curves = nullptr;  ///< one for each node, or null if none are needed
  const MotionFloor* floors = nullptr;  ///< one for each node, or null without a floor

  /// Replaces, repeatedly, both halves of a smooth node by the node itself. list: nodes in the
  /// order of the poses. Returns how many are left.
  CLEARWAY_HD std::uint32_t join_smooth(std::uint32_t* list, std::uint32_t count) const {
    return join(list, count, [&](std::uint32_t node) { return curves[node].is_smooth(); });
  }

  /// Replaces, repeatedly, both halves of a node for which is_whole(node) is true by the node
  /// itself. list: nodes in the order of the poses. Returns how many are left.
  template <typename IsWhole>
  CLEARWAY_HD std::uint32_t join(std::uint32_t* list, std::uint32_t count, IsWhole is_whole) const {
    std::uint32_t left = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      list[left++] = list[i];
      while (left > 1 && are_halves(list[left - 2], list[left - 1]) &&
             is_whole(list[left - 2] - 1)) {
        --list[--left - 1];
      }
    }
    return left;
  }

 private:
  /// Whether two nodes are the halves of one node, which is then earlier - 1.
  CLEARWAY_HD bool are_halves(std::uint32_t earlier, std::uint32_t later) const {
    return earlier > 0 && nodes[earlier - 1].later == later;
  }
};

}  // namespace clearway
