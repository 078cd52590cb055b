#pragma once

#include <span>
#include <vector>

#include "clearway/vec3.hpp"

namespace clearway::scene {

/// A place beside the path, in metres: arc length along it, offset to the left of it, height above
/// it.
struct PathPoint {
  double s, v, w;
};

/// Position and heading of the path at one arc length. The frame stays upright: z is up whatever
/// the slope.
struct PathFrame {
  Vec3 position;
  double cos_heading, sin_heading;
};

/// A piece of path over which the curvature (1 / m, left positive) goes linearly from where the
/// piece before ended to `end_curvature`: a clothoid, or an arc where both are equal.
struct PathPiece {
  double length;
  double end_curvature;
};

/// A smooth curve, tabulated by arc length. Open paths go on straight beyond their ends, closed
/// ones around.
class Path {
 public:
  static Path from_pieces(std::span<const PathPiece> pieces, double slope);
  /// The closed uniform cubic B-spline of these control points.
  static Path closed_spline(std::span<const Vec3> control);

  double length() const { return length_; }
  bool closed() const { return closed_; }
  PathFrame at(double s) const;
  Vec3 to_world(const PathPoint& point) const;
  /// The unit tangent at s, slope included.
  Vec3 direction(double s) const;

 private:
  Path(std::vector<PathFrame> table, double step, bool closed);

  std::vector<PathFrame> table_;  ///< at 0, step_, ..., length_
  double step_;
  double length_;
  bool closed_;
};

}  // namespace clearway::scene
