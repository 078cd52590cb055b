#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "clearway/box.hpp"
#include "clearway/conflicts.hpp"
#include "clearway/query.hpp"
#include "core/util/progress.hpp"
#include "findings/point_blocks.hpp"
#include "findings/touched_first.hpp"

namespace clearway {

/// Where points lie across a body, seen along its path: to the left and up in its frame.
struct AcrossBody {
  double left_from = kMost, left_to = -kMost;  ///< y0 and y1, metres to the left
  double up_from = kMost, up_to = -kMost;      ///< z0 and z1, metres up
  /// Whether any of the points lies in the middle half of the body's width and height.
  bool in_middle = false;

  bool is_empty() const { return left_from > left_to; }
  void add(const AcrossBody& other);
  friend bool operator==(const AcrossBody&, const AcrossBody&) = default;

 private:
  static constexpr double kMost = std::numeric_limits<double>::infinity();
};

/// What moves, and how it is seen. All references must outlive it.
struct BodiesAcross {
  std::span<const MovingBody> bodies;
  std::span<const Box> boxes;  ///< of each body's model, in its own frame
  AheadLeftUp axes;
  double radius;
  bool ways;  ///< whether bodies are followed from pose to pose

  /// The box of a body along the axes of ahead_left_up().
  Box whole_box(std::uint32_t body) const;
  /// The box of a body from its floor up, along the axes of ahead_left_up().
  Box box_from_floor(std::uint32_t body) const;
};

/// Points of a conflict, seen from the body that touches them first.
struct PointsBeside {
  const PointBlocks& points;
  std::uint32_t body;
  /// The poses of the conflict's range; between poses, those of all of its ways.
  std::uint32_t first_pose, last_pose;
};

/// Finds where the points of each conflict lie across its body, at all poses of its range at which
/// they are closer than the radius to the body's box and at its floor or above; between poses, at
/// both ends of each way that may come so near, and as far beyond as the body's turn may take them.
/// Runs in the caller's arena of oneTBB. Throws Interrupted.
std::vector<AcrossBody> find_across_bodies(const BodiesAcross& how,
                                           std::span<const PointsBeside> conflicts,
                                           Progress& progress);

/// Sets the trims and the side of a conflict, whose first_touch is known. body: the body's box from
/// its floor up, and whole: its box, both along the axes of ahead_left_up().
void set_trims(const AcrossBody& found, const Box& body, const Box& whole, double radius,
               Conflict& conflict);

}  // namespace clearway
