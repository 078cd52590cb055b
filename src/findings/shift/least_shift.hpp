#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "clearway/pose.hpp"
#include "clearway/query.hpp"
#include "clearway/vec3.hpp"
#include "core/util/progress.hpp"
#include "findings/point_blocks.hpp"

namespace clearway {

/// The least shifts to the left and to the right, in metres; nothing on a side where even the
/// longest shift does not free the points.
struct SideShifts {
  std::optional<double> left, right;
  friend bool operator==(const SideShifts&, const SideShifts&) = default;
};

/// Points that a shift has to free at the poses from `first` to `last`.
struct PointsToFree {
  const PointBlocks* points = nullptr;  ///< null: none
  std::uint32_t first = 0, last = 0;
};

/// What is shifted. All references must outlive it.
struct ShiftQuestion {
  std::span<const MovingBody> bodies;
  const std::vector<Pose>& path;
  Vec3 left;  ///< to the left in the frame of the path's poses: +Y if the front points along +X
  double radius;
  /// Whether model points move on straight segments from pose to pose, which are looked at in steps
  /// of half the radius.
  bool ways;
  /// About how many pairs of a point and a pose are asked about; more of them are worth more
  /// preparation.
  std::uint64_t pairs;
  double most;  ///< the longest shift that is looked for, metres
  int threads;
};

/// How far a vehicle has to be shifted to one side so that given points no longer collide with it.
/// A shift by l moves every body at pose i of the path by l times the axis of that pose that points
/// to the left (docs/design/findings.md, "Own shifts"). A point below a body's floor does not
/// collide with it. Returns for each set of points the least shifts at which none of them collides
/// at any of its poses, the same for any number of threads. Progress advances by one for each set.
/// Runs in the caller's arena of oneTBB. Throws Interrupted.
std::vector<SideShifts> least_shifts(const ShiftQuestion& asked, std::span<const PointsToFree> sets,
                                     Progress& progress);

}  // namespace clearway
