#include "core/trajectory/alignment/alignment.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace clearway {

AlignmentProfile::AlignmentProfile(std::vector<VerticalIntersection> points)
    : points_(std::move(points)) {
  const std::size_t last = points_.size() - 1;
  for (std::size_t i = 1; i < last; ++i) {
    VerticalIntersection& point = points_[i];
    if (point.curve != VerticalIntersection::Curve::kCircle) continue;
    const double a1 = std::atan(slope_after(i - 1)), a2 = std::atan(slope_after(i));
    const double tangent = point.radius * std::tan(std::abs(a2 - a1) / 2);
    point.before = tangent * std::cos(a1);
    point.after = tangent * std::cos(a2);
  }
  // Where curves touch or overlap, the slope between them has no length.
  const auto begin_piece = [this](const Piece& piece) {
    while (!pieces_.empty() && pieces_.back().begin >= piece.begin) pieces_.pop_back();
    pieces_.push_back(piece);
  };
  begin_piece({first_station(), 0, false});
  for (std::size_t i = 1; i < last; ++i) {
    if (points_[i].curve != VerticalIntersection::Curve::kNone) begin_piece({begin_of(i), i, true});
    begin_piece({end_of(i), i, false});
  }
}

double AlignmentProfile::slope_after(std::size_t point) const {
  const VerticalIntersection &from = points_[point], &to = points_[point + 1];
  return (to.height - from.height) / (to.station - from.station);
}

double AlignmentProfile::overlap_before(std::size_t point) const {
  return end_of(point - 1) - begin_of(point);
}

SlopedValue AlignmentProfile::on_parabola(std::size_t i, double station) const {
  const VerticalIntersection& point = points_[i];
  const double g1 = slope_after(i - 1), g2 = slope_after(i);
  const double l1 = point.before, l2 = point.after;
  const double most = l1 * l2 * (g2 - g1) / (2 * (l1 + l2));  // above or below the point itself
  const double ahead = station - point.station;
  if (ahead < 0) {
    const double x = (l1 + ahead) / l1;
    return {point.height + g1 * ahead + most * x * x, g1 + 2 * most * x / l1};
  }
  const double x = (l2 - ahead) / l2;
  return {point.height + g2 * ahead + most * x * x, g2 - 2 * most * x / l2};
}

SlopedValue AlignmentProfile::on_circle(std::size_t i, double station) const {
  const VerticalIntersection& point = points_[i];
  const double g1 = slope_after(i - 1), g2 = slope_after(i);
  const double a1 = std::atan(g1), x = station - begin_of(i);
  const double bend = g2 > g1 ? 1 : -1;
  const double a = std::asin(std::clamp(std::sin(a1) + bend * x / point.radius, -1.0, 1.0));
  // A chord of a circle has the mean direction of the tangents at its ends.
  return {point.height - g1 * point.before + x * std::tan((a1 + a) / 2), std::tan(a)};
}

SlopedValue AlignmentProfile::at(double station) const {
  auto next = std::upper_bound(pieces_.begin(), pieces_.end(), station,
                               [](double s, const Piece& piece) { return s < piece.begin; });
  const Piece piece = next == pieces_.begin() ? pieces_.front() : *(next - 1);
  const VerticalIntersection& point = points_[piece.point];
  if (!piece.is_curve) {
    const double slope = slope_after(piece.point);
    return {point.height + slope * (station - point.station), slope};
  }
  return point.curve == VerticalIntersection::Curve::kCircle ? on_circle(piece.point, station)
                                                             : on_parabola(piece.point, station);
}

SlopedValue along_ramp(CantRamp ramp, double share) {
  using std::numbers::pi;
  const double t = share;
  switch (ramp) {
    case CantRamp::kLinear:
      break;
    case CantRamp::kBloss:
      return {t * t * (3 - 2 * t), 6 * t * (1 - t)};
    case CantRamp::kSinusoid:
      return {t - std::sin(2 * pi * t) / (2 * pi), 1 - std::cos(2 * pi * t)};
    case CantRamp::kCosine:
      return {(1 - std::cos(pi * t)) / 2, pi * std::sin(pi * t) / 2};
  }
  return {t, 1};
}

SlopedValue AlignmentCant::at(double station) const {
  const auto next =
      std::upper_bound(points_.begin(), points_.end(), station,
                       [](double s, const CantPoint& point) { return s < point.station; });
  if (next == points_.begin()) return {points_.front().cant, 0};
  if (next == points_.end()) return {points_.back().cant, 0};
  const CantPoint &from = *(next - 1), &to = *next;
  const double way = to.station - from.station, slope = (to.cant - from.cant) / way;
  if (from.ramp == CantRamp::kLinear) {
    return {from.cant + slope * (station - from.station), slope};
  }
  const SlopedValue part = along_ramp(from.ramp, (station - from.station) / way);
  return {from.cant + (to.cant - from.cant) * part.value, slope * part.slope};
}

namespace {

/// How far the middle of the track is above the profile where the left rail is above the right one
/// by `cant`.
SlopedValue raise_of(const SlopedValue& cant, CantLine line) {
  // On the border between a left and a right curve the direction of the change decides.
  const bool to_the_right = cant.value > 0 || (cant.value == 0 && cant.slope >= 0);
  const double side = to_the_right ? 1 : -1;
  double share = 0;
  switch (line) {
    case CantLine::kFile:
    case CantLine::kNone:
    case CantLine::kCenter:
      break;
    case CantLine::kInsideRail:
      share = side;
      break;
    case CantLine::kOutsideRail:
      share = -side;
      break;
    case CantLine::kLeftRail:
      share = -1;
      break;
    case CantLine::kRightRail:
      share = 1;
      break;
  }
  return {share * cant.value / 2, share * cant.slope / 2};
}

}  // namespace

Pose pose_on_track(const PlanPlace& place, SlopedValue height,
                   const std::optional<SlopedValue>& cant, CantLine cant_line,
                   double rail_distance) {
  double sin_roll = 0;
  if (cant) {
    const SlopedValue raise = raise_of(*cant, cant_line);
    height.value += raise.value;
    height.slope += raise.slope;
    sin_roll = cant->value / rail_distance;
  }
  const double cos_roll = std::sqrt((1 - sin_roll) * (1 + sin_roll));
  const double cos_climb = 1 / std::hypot(1.0, height.slope), sin_climb = height.slope * cos_climb;
  const double c = std::cos(place.heading), s = std::sin(place.heading);
  // X along the way, Y0 level to the left, Z0 = X x Y0; roll lifts the left side.
  const double x[3] = {cos_climb * c, cos_climb * s, sin_climb};
  const double y0[3] = {-s, c, 0};
  const double z0[3] = {-sin_climb * c, -sin_climb * s, cos_climb};
  Pose pose{{}, {place.at.real(), place.at.imag(), height.value}};
  for (int k = 0; k < 3; ++k) {
    // The sum with 0 leaves no negative zeros, which people would wonder about.
    pose.rotation[3 * k] = x[k] + 0.0;
    pose.rotation[3 * k + 1] = cos_roll * y0[k] + sin_roll * z0[k] + 0.0;
    pose.rotation[3 * k + 2] = cos_roll * z0[k] - sin_roll * y0[k] + 0.0;
  }
  return pose;
}

Pose Alignment::pose_at(double station) const {
  return pose_on_track(plan.at(station), profile ? profile->at(station) : SlopedValue{level, 0},
                       cant ? std::optional(cant->at(station)) : std::nullopt, cant_line,
                       rail_distance);
}

}  // namespace clearway
