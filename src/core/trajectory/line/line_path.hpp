#pragma once

#include <complex>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "clearway/pose.hpp"
#include "core/trajectory/alignment/alignment.hpp"
#include "core/trajectory/follow/path_stations.hpp"

namespace clearway {

class PoseSpline;

/// A vertex of a line in plan, x + i y, in metres.
using PlanPoint = std::complex<double>;

/// The angle in radians by which a line turns at a vertex that is neither its first nor its last
/// one: positive to the left, from -pi to pi.
double turn_at(std::span<const PlanPoint> vertices, std::size_t vertex);

/// A leg of a line that is too short for the arcs at its two ends.
struct ShortLeg {
  std::size_t from = 0;  ///< the vertex at which the leg begins
  double length = 0;     ///< metres
  double needed = 0;     ///< metres that the arcs at both ends take of it
};

/// The legs that are too short for arcs of a radius, in metres, at all vertices.
std::vector<ShortLeg> short_legs(std::span<const PlanPoint> vertices, double radius);
/// The largest radius, in metres, whose arcs fit on all legs; infinite for a straight line.
double largest_radius(std::span<const PlanPoint> vertices);

/// A line in plan. A place is given by its distance along the line from the first vertex, in
/// metres, which is the station here. docs/design/trajectory.md, "Lines".
class LinePlan {
 public:
  /// The cubic through all vertices. vertices: two at least, none at the place of the one before.
  static LinePlan through(std::span<const PlanPoint> vertices);
  /// Straight legs, and an arc of `radius` metres that touches both legs at every vertex where the
  /// line turns. No leg may be too short for it.
  static LinePlan rounded(std::span<const PlanPoint> vertices, double radius);

  double length() const;
  /// The station of a vertex; that of the middle of its arc where it is rounded.
  double station_of(std::size_t vertex) const { return stations_[vertex]; }
  /// Length of the arc at a vertex; 0 where it has none.
  double arc_at(std::size_t vertex) const { return arcs_.empty() ? 0 : arcs_[vertex]; }
  /// The place at a station from 0 to length().
  PlanPlace at(double station) const;

 private:
  /// A straight piece or an arc of a line that is rounded.
  struct Piece {
    double begin = 0;  ///< station
    PlanPoint start;   ///< relative to the first vertex
    double heading = 0;
    double curvature = 0;  ///< 1/m, positive to the left
  };

  LinePlan() = default;
  void add_piece(PlanPoint start, double heading, double curvature, double length);

  PlanPoint origin_;              ///< the first vertex, from which the cubic and the pieces count
  std::vector<double> stations_;  ///< of the vertices
  std::vector<double> arcs_;      ///< at the vertices; empty for a cubic
  std::vector<Piece> pieces_;     ///< empty for a cubic
  double length_ = 0;             ///< of all pieces
  std::vector<Pose> knots_;       ///< the vertices of a cubic
  std::optional<PathStations> cubic_;
};

/// Heights along a line: the cubic of PoseSpline through given ones, with the station as its
/// parameter.
class HeightCurve {
 public:
  /// stations: ascending, two at least. heights: metres, one for each of them.
  HeightCurve(std::vector<double> stations, std::span<const double> heights);
  ~HeightCurve();
  HeightCurve(HeightCurve&&) noexcept;

  /// Height and slope at a station from the first to the last one.
  SlopedValue at(double station) const;

 private:
  std::vector<double> stations_;
  std::vector<Pose> knots_;  ///< the heights as z
  std::unique_ptr<const PoseSpline> spline_;
};

/// The heights of a line whose legs are straight: straight slopes too, with a parabola at each
/// inner vertex. It is as long as the vertex's arc, or as an arc of `radius` between the two slopes
/// where that is longer and there is room for it. heights: of the vertices, metres.
AlignmentProfile rounded_profile(const LinePlan& plan, std::span<const double> heights,
                                 double radius);

/// A line in metres and the way in which a vehicle stands on it.
struct LinePath {
  LinePlan plan;
  /// The heights; a number for the height of all places.
  std::variant<double, HeightCurve, AlignmentProfile> height;
  std::optional<AlignmentCant> cant = {};
  CantLine cant_line = CantLine::kCenter;
  double rail_distance = 1.5;

  /// The height at a station and its slope.
  SlopedValue height_at(double station) const;
  /// The pose at a station: x forward, y left, z up.
  Pose pose_at(double station) const;
};

}  // namespace clearway
