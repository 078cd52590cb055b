#pragma once

#include <cstdint>
#include <memory>
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

/// How far a vehicle has to be shifted to one side so that given points no longer collide with it.
/// A shift by l moves every body at pose i of the path by l times the axis of that pose that points
/// to the left (docs/design/findings.md, "Own shifts").
class LeastShift {
 public:
  /// left: the direction to the left in the frame of the path's poses, +Y for a vehicle whose front
  /// points along +X. ways: whether model points move on straight segments from pose to pose, which
  /// are looked at in steps of half the radius. A point below a body's floor does not collide with
  /// it. pairs: about how many pairs of a point and a pose will be asked about; more of them are
  /// worth more preparation. All references outlive it. Runs in the caller's arena of oneTBB.
  LeastShift(std::span<const MovingBody> bodies, const std::vector<Pose>& path, const Vec3& left,
             double radius, bool ways, std::uint64_t pairs, int threads);
  ~LeastShift();
  LeastShift(const LeastShift&) = delete;
  LeastShift& operator=(const LeastShift&) = delete;

  /// For each set of points, the least shifts of at most `most` metres at which none of them
  /// collides at any of its poses. The same for any number of threads.
  /// Progress advances by one for each set. Runs in the caller's arena of oneTBB. Throws
  /// Interrupted.
  std::vector<SideShifts> least(std::span<const PointsToFree> sets, double most,
                                Progress& progress) const;

 private:
  class Shape;
  struct Instant;
  struct Bounds;
  struct Unit;
  class Round;
  class UnitSearch;

  void add_instants(std::size_t body, std::uint32_t pose, bool with_way, double direction,
                    std::vector<Instant>& out) const;
  void add_instant(const Pose& pose, const Pose& of_path, double direction,
                   std::vector<Instant>& out) const;

  std::span<const MovingBody> bodies_;
  const std::vector<Pose>& path_;
  const Vec3 left_;
  const double radius_;
  const bool ways_;
  double longest_left_ = 0;                     ///< the greatest length of the left axis of a pose
  std::vector<std::unique_ptr<Shape>> shapes_;  ///< one for each body
};

}  // namespace clearway
