#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "clearway/box.hpp"
#include "clearway/vec3.hpp"

namespace clearway {

/// The places within a distance of a path, which consists of the segments between consecutive
/// positions; of a single position, where there is only one (docs/design/pipeline.md).
class Corridor {
 public:
  /// path: finite positions, at least one. within: finite, 0 or above.
  Corridor(std::vector<Vec3> path, double within);

  std::span<const Vec3> path() const { return path_; }
  double within() const { return within_; }

  /// The least computed squared distance of a place to any segment. Each is that of the place
  /// a + t (b - a) with t = clamp(dot(p - a, b - a) / dot(b - a, b - a), 0, 1), or 0 where a = b.
  double squared_distance(const Vec3& p) const;
  /// Whether that is at most the square of within().
  bool holds(const Vec3& p) const;
  /// An upper bound on the true distance of a place to the path.
  double distance_above(const Vec3& p) const;
  /// False only where no place of the box is held.
  bool may_hold(const Box& box) const;

  /// Bound on what rounding adds to a computed distance of a place whose coordinates are no larger
  /// than those of the path, metres.
  double rounding() const { return 16 * slack_; }

  std::uint64_t allocated_bytes() const {
    return path_.capacity() * sizeof(Vec3) + boxes_.capacity() * sizeof(Box);
  }

 private:
  std::uint32_t segments() const {
    return static_cast<std::uint32_t>(path_.size() > 1 ? path_.size() - 1 : 1);
  }
  Box build(std::uint32_t node, std::uint32_t first, std::uint32_t count);
  Box box_of_segment(std::uint32_t segment) const;
  double squared_to_segment(const Vec3& p, std::uint32_t segment) const;
  template <typename IsNear, typename Visit>
  void descend(std::uint32_t node, std::uint32_t first, std::uint32_t count, const IsNear& is_near,
               const Visit& visit) const;

  std::vector<Vec3> path_;
  double within_;
  double slack_ = 0;  ///< how far a computed place of a segment may lie outside of its box
  /// Boxes of runs of segments, each wider by the slack: those of a node are halved until at most
  /// kLeaf are left; node n has the children 2 n + 1 and 2 n + 2.
  std::vector<Box> boxes_;
};

/// Asks a corridor about places that mostly lie near the one asked before, so that most answers
/// follow from the distance of an earlier place. For one thread.
class CorridorWalk {
 public:
  explicit CorridorWalk(const Corridor& corridor) : corridor_(corridor) {}

  /// What Corridor::holds() says.
  bool holds(const Vec3& p);

 private:
  const Corridor& corridor_;
  Vec3 anchor_{};
  double distance_ = -1;  ///< of the anchor; negative: there is none yet
};

}  // namespace clearway
