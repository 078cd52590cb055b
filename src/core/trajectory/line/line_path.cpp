#include "core/trajectory/line/line_path.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/trajectory/pose_spline.hpp"

namespace clearway {
namespace {

constexpr Pose kLevel{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};

/// Metres of a leg that the arc at a vertex takes, for a radius of 1 m.
double tangent_at(std::span<const PlanPoint> vertices, std::size_t vertex) {
  if (vertex == 0 || vertex + 1 == vertices.size()) return 0;
  return std::tan(std::abs(turn_at(vertices, vertex)) / 2);
}

/// Calls visit(leg, its length, metres that both arcs take of it for a radius of 1 m) for each leg.
template <typename Visit>
void each_leg(std::span<const PlanPoint> vertices, const Visit& visit) {
  double before = 0;
  for (std::size_t i = 0; i + 1 < vertices.size(); ++i) {
    const double after = tangent_at(vertices, i + 1);
    visit(i, std::abs(vertices[i + 1] - vertices[i]), before + after);
    before = after;
  }
}

/// Arcs that touch each other, as on a semicircle of two corners, may overlap by rounding.
constexpr double kArcRounding = 1e-9;

}  // namespace

double turn_at(std::span<const PlanPoint> vertices, std::size_t vertex) {
  const PlanPoint before = vertices[vertex] - vertices[vertex - 1];
  const PlanPoint after = vertices[vertex + 1] - vertices[vertex];
  return std::arg(after * std::conj(before));
}

std::vector<ShortLeg> short_legs(std::span<const PlanPoint> vertices, double radius) {
  std::vector<ShortLeg> found;
  each_leg(vertices, [&](std::size_t from, double length, double share) {
    const double needed = radius * share;
    if (!(needed <= length * (1 + kArcRounding))) found.push_back({from, length, needed});
  });
  return found;
}

double largest_radius(std::span<const PlanPoint> vertices) {
  double largest = std::numeric_limits<double>::infinity();
  each_leg(vertices, [&](std::size_t, double length, double share) {
    if (share > 0) largest = std::min(largest, length / share);
  });
  return largest;
}

LinePlan LinePlan::through(std::span<const PlanPoint> vertices) {
  LinePlan plan;
  plan.origin_ = vertices.front();
  for (const PlanPoint& vertex : vertices) {
    const PlanPoint at = vertex - plan.origin_;
    Pose knot = kLevel;
    knot.translation[0] = at.real();
    knot.translation[1] = at.imag();
    plan.knots_.push_back(knot);
  }
  plan.cubic_.emplace(plan.knots_, 1);
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    plan.stations_.push_back(plan.cubic_->of_pose(i));
  }
  return plan;
}

LinePlan LinePlan::rounded(std::span<const PlanPoint> vertices, double radius) {
  LinePlan plan;
  plan.origin_ = vertices.front();
  plan.stations_.push_back(0);
  plan.arcs_.push_back(0);
  double used = 0;  // metres of the leg that the arc at its start took
  for (std::size_t i = 0; i + 1 < vertices.size(); ++i) {
    const PlanPoint leg = vertices[i + 1] - vertices[i];
    const double length = std::abs(leg), heading = std::arg(leg);
    const PlanPoint along = leg / length;
    const bool last = i + 2 == vertices.size();
    const double turn = last ? 0 : turn_at(vertices, i + 1);
    const double tangent = radius * tangent_at(vertices, i + 1);
    const PlanPoint start = vertices[i] - plan.origin_ + used * along;
    plan.add_piece(start, heading, 0, std::max(0.0, length - used - tangent));
    const double arc = radius * std::abs(turn);
    plan.stations_.push_back(plan.length_ + arc / 2);
    plan.arcs_.push_back(arc);
    const PlanPoint end = vertices[i + 1] - plan.origin_ - tangent * along;
    plan.add_piece(end, heading, (turn < 0 ? -1 : 1) / radius, arc);
    used = tangent;
  }
  return plan;
}

void LinePlan::add_piece(PlanPoint start, double heading, double curvature, double length) {
  if (!(length > 0)) return;
  pieces_.push_back({length_, start, heading, curvature});
  length_ += length;
}

double LinePlan::length() const { return cubic_ ? cubic_->length() : length_; }

PlanPlace LinePlan::at(double station) const {
  if (cubic_) {
    const double inside = std::clamp(station, 0.0, cubic_->length());
    const PathStations::Place place =
        cubic_->ahead_of(0, inside).value_or(PathStations::Place{knots_.size() - 1, 0});
    const Pose pose = cubic_->pose_at(place);
    const Vec3 direction = cubic_->direction_at(place);
    return {origin_ + PlanPoint(pose.translation[0], pose.translation[1]),
            std::atan2(direction.y, direction.x)};
  }
  const auto next = std::upper_bound(pieces_.begin() + 1, pieces_.end(), station,
                                     [](double s, const Piece& piece) { return s < piece.begin; });
  const Piece& piece = *(next - 1);
  const double along = std::clamp(station, 0.0, length_) - piece.begin;
  // A chord of an arc has the mean direction of its ends.
  const double half_turn = piece.curvature * along / 2;
  const double chord = piece.curvature == 0 ? along : 2 * std::sin(half_turn) / piece.curvature;
  return {origin_ + piece.start + std::polar(1.0, piece.heading + half_turn) * chord,
          piece.heading + 2 * half_turn};
}

HeightCurve::HeightCurve(std::vector<double> stations, std::span<const double> heights)
    : stations_(std::move(stations)) {
  for (const double height : heights) {
    knots_.push_back(kLevel);
    knots_.back().translation[2] = height;
  }
  // The spline's parameter is the square root of the motion between two poses.
  std::vector<double> motions;
  for (std::size_t i = 0; i + 1 < stations_.size(); ++i) {
    const double span = stations_[i + 1] - stations_[i];
    motions.push_back(span * span);
  }
  spline_ = std::make_unique<PoseSpline>(knots_, motions);
}

HeightCurve::~HeightCurve() = default;
HeightCurve::HeightCurve(HeightCurve&&) noexcept = default;

SlopedValue HeightCurve::at(double station) const {
  const auto next = std::upper_bound(stations_.begin() + 1, stations_.end() - 1, station);
  const auto way = static_cast<std::size_t>(next - stations_.begin()) - 1;
  const double span = stations_[way + 1] - stations_[way];
  const double t = std::clamp((station - stations_[way]) / span, 0.0, 1.0);
  const PositionCurve curve = spline_->positions(way);
  return {knots_[way].translation[2] + curve.displacement(t).z(), curve.velocity(t).z() / span};
}

AlignmentProfile rounded_profile(const LinePlan& plan, std::span<const double> heights,
                                 double radius) {
  const std::size_t last = heights.size() - 1;
  std::vector<VerticalIntersection> points;
  for (std::size_t i = 0; i <= last; ++i) points.push_back({plan.station_of(i), heights[i]});
  const auto slope_after = [&](std::size_t i) {
    return (points[i + 1].height - points[i].height) / (points[i + 1].station - points[i].station);
  };
  // Straight metres between the arcs at both ends of a leg.
  const auto free_after = [&](std::size_t i) {
    return points[i + 1].station - points[i].station - (plan.arc_at(i) + plan.arc_at(i + 1)) / 2;
  };
  for (std::size_t i = 1; i < last; ++i) {
    const double before = slope_after(i - 1), after = slope_after(i);
    if (before == after) continue;
    const double arc = plan.arc_at(i) / 2;
    const double wanted = radius * std::tan(std::abs(std::atan(after) - std::atan(before)) / 2);
    const double room = std::max(0.0, std::min(free_after(i - 1), free_after(i)) / 2);
    const double half = std::max(arc, std::min(wanted, arc + room));
    if (!(half > 0)) continue;
    points[i].curve = VerticalIntersection::Curve::kParabola;
    points[i].before = points[i].after = half;
  }
  return AlignmentProfile(std::move(points));
}

SlopedValue LinePath::height_at(double station) const {
  if (const double* level = std::get_if<double>(&height)) return {*level, 0};
  if (const auto* curve = std::get_if<HeightCurve>(&height)) return curve->at(station);
  return std::get<AlignmentProfile>(height).at(station);
}

Pose LinePath::pose_at(double station) const {
  return pose_on_track(plan.at(station), height_at(station),
                       cant ? std::optional(cant->at(station)) : std::nullopt, cant_line,
                       rail_distance);
}

}  // namespace clearway
