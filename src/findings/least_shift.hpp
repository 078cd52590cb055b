#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "clearway/pose.hpp"
#include "clearway/query.hpp"
#include "clearway/vec3.hpp"

namespace clearway {

/// The least shifts to the left and to the right, in metres; nothing on a side where even the
/// longest shift does not free the points.
struct SideShifts {
  std::optional<double> left, right;
};

/// How far a vehicle has to be shifted to one side so that given points no longer collide with it.
/// A shift by l moves every body at pose i of the path by l times the axis of that pose that points
/// to the left (docs/design/findings.md, "Own shifts"). Thread safe once constructed.
class LeastShift {
 public:
  /// left: the direction to the left in the frame of the path's poses, +Y for a vehicle whose front
  /// points along +X. ways: whether model points move on straight segments from pose to pose, which
  /// are looked at in steps of half the radius. A point below a body's floor does not collide with
  /// it. All references outlive it.
  LeastShift(std::span<const MovingBody> bodies, const std::vector<Pose>& path, const Vec3& left,
             double radius, bool ways, int threads);
  ~LeastShift();
  LeastShift(const LeastShift&) = delete;
  LeastShift& operator=(const LeastShift&) = delete;

  /// The least shifts, of at most `most` metres, at which none of the points collides at any pose
  /// from `first` to `last`.
  SideShifts least(std::span<const Vec3> points, std::uint32_t first, std::uint32_t last,
                   double most) const;

 private:
  class Shape;
  struct Run;
  void add_runs(std::size_t body, const Pose& pose, const Pose& of_path,
                std::span<const Vec3> points, double most, std::vector<Run>& runs,
                std::vector<Vec3>& seen) const;
  std::span<const MovingBody> bodies_;
  const std::vector<Pose>& path_;
  const Vec3 left_;
  const double radius_;
  const bool ways_;
  std::vector<std::unique_ptr<Shape>> shapes_;  ///< one for each body
};

}  // namespace clearway
