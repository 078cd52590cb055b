#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "clearway/alignment.hpp"
#include "clearway/pose.hpp"
#include "core/trajectory/alignment/plan.hpp"

namespace clearway {

/// A value along an alignment, and its change per metre of station.
struct SlopedValue {
  double value = 0, slope = 0;
};

/// A point of intersection of a profile, where two slopes meet, and the curve that rounds it.
struct VerticalIntersection {
  enum class Curve {
    kNone,
    kParabola,  ///< two parabolas that meet at the point's station, or one if they are as long
    kCircle
  };

  double station = 0, height = 0;  ///< metres
  Curve curve = Curve::kNone;
  double before = 0, after = 0;  ///< kParabola: level metres of the curve on either side, above 0
  double radius = 0;             ///< kCircle: metres, above 0
};

/// The heights of an alignment: straight slopes between points, rounded by curves.
class AlignmentProfile {
 public:
  /// points: at least two, with ascending stations; the first and the last have no curve.
  explicit AlignmentProfile(std::vector<VerticalIntersection> points);

  double first_station() const { return points_.front().station; }
  double last_station() const { return points_.back().station; }
  /// Height and slope at a station that the profile reaches. Where curves overlap, the later one
  /// counts.
  SlopedValue at(double station) const;

  /// Metres by which the curve of a point begins before the previous curve ends, and the last curve
  /// ends after the profile; not above 0 where it does not. point: not the first.
  double overlap_before(std::size_t point) const;

 private:
  struct Piece {
    double begin = 0;       ///< station
    std::size_t point = 0;  ///< the point of a curve, or that before a slope
    bool is_curve = false;
  };

  double slope_after(std::size_t point) const;
  SlopedValue on_parabola(std::size_t point, double station) const;
  SlopedValue on_circle(std::size_t point, double station) const;
  double begin_of(std::size_t point) const {
    return points_[point].station - points_[point].before;
  }
  double end_of(std::size_t point) const { return points_[point].station + points_[point].after; }

  std::vector<VerticalIntersection> points_;  ///< `before` and `after` of circles are filled in
  std::vector<Piece> pieces_;
};

/// How the cant changes from one point to the next. t is the share of the way, from 0 to 1.
enum class CantRamp {
  kLinear,    ///< t
  kBloss,     ///< 3 t^2 - 2 t^3
  kSinusoid,  ///< t - sin(2 pi t) / (2 pi)
  kCosine     ///< (1 - cos(pi t)) / 2
};

/// The share of a ramp's change that is reached at a share of its way, and the derivative of the
/// one by the other.
SlopedValue along_ramp(CantRamp ramp, double share);

/// The cant at a station: how far the left rail is above the right one, in metres.
struct CantPoint {
  double station = 0, cant = 0;
  CantRamp ramp = CantRamp::kLinear;  ///< from here to the next point
};

/// The cant of an alignment, which has ramps between its points and is kept beyond them.
class AlignmentCant {
 public:
  /// points: at least one, with ascending stations.
  explicit AlignmentCant(std::vector<CantPoint> points) : points_(std::move(points)) {}

  const std::vector<CantPoint>& points() const { return points_; }
  SlopedValue at(double station) const;

 private:
  std::vector<CantPoint> points_;
};

/// The pose of a vehicle on a track: x forward, y left, z up, the origin in the middle of the track
/// on the plane of the tops of the rails. height: of the line about which cant turns the track,
/// with its slope along the way. cant: how far the left rail is above the right one, with its
/// change along the way; none where the track is level across. rail_distance: metres.
Pose pose_on_track(const PlanPlace& place, SlopedValue height,
                   const std::optional<SlopedValue>& cant, CantLine cant_line,
                   double rail_distance);

/// An alignment in metres and the way in which a vehicle stands on it.
struct Alignment {
  AlignmentPlan plan;
  std::optional<AlignmentProfile> profile = {};
  double level = 0;  ///< height everywhere where there is no profile
  std::optional<AlignmentCant> cant = {};
  CantLine cant_line = CantLine::kCenter;
  double rail_distance = 1.5;

  /// The pose at a station: x forward, y left, z up, the origin in the middle of the track on the
  /// plane of the tops of the rails. station: where plan and profile reach.
  Pose pose_at(double station) const;
};

}  // namespace clearway
